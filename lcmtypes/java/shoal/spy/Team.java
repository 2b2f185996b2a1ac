// SPDX-License-Identifier: BSD-3-Clause
package shoal.spy;

import java.util.ArrayList;
import java.util.Arrays;
import java.util.HashMap;
import java.util.List;
import java.util.Map;
import java.util.TreeMap;

/**
 * What robots said: of each topic and brick the parts of the newest version whose part 0 has come. Of each robot one
 * epoch counts, the newest. Holds at most 4 million cells and words; what comes above is passed over. For any thread.
 */
public final class Team {
  private static final int MOST = 4000000, VERSIONS = 3;

  private static final class Version {
    int observation;
    final TreeMap<Integer, Piece> parts = new TreeMap<>();
  }

  private static final class Robot {
    int epoch = -1;
    final Map<List<Object>, List<Version>> pieces = new HashMap<>();
  }

  private final TreeMap<Integer, Robot> robots = new TreeMap<>();
  private int held;
  private long changes;

  /** Takes a message; false when it is damaged or of a kind that is not read here. */
  public boolean hear(byte[] message) {
    List<Piece> pieces;
    try {
      pieces = Piece.read(message);
    } catch (BadMessage bad) {
      return false;
    }
    for (Piece piece : pieces) hear(piece);
    return true;
  }

  private static int size(Piece piece) { return 1 + piece.values.length + piece.words.size(); }

  private synchronized void hear(Piece piece) {
    Robot robot = robots.get(piece.robot);
    if (robot == null) {
      if (robots.size() >= 256) return;
      robots.put(piece.robot, robot = new Robot());
    }
    if (piece.epoch < robot.epoch) return;
    if (piece.epoch > robot.epoch) {
      for (List<Version> versions : robot.pieces.values())
        for (Version version : versions) forget(version);
      robot.pieces.clear();
      robot.epoch = piece.epoch;
    }
    if (held + size(piece) > MOST) return;
    List<Version> versions = robot.pieces.computeIfAbsent(Arrays.asList(piece.kind, piece.index), k -> new ArrayList<>());
    int at = 0;  // the newest first
    while (at < versions.size() && versions.get(at).observation > piece.observation) ++at;
    if (at > 0 && versions.get(at - 1).parts.containsKey(0)) return;  // a newer one counts
    if (at == versions.size() || versions.get(at).observation != piece.observation) {
      versions.add(at, new Version());
      versions.get(at).observation = piece.observation;
    }
    Version version = versions.get(at);
    if (version.parts.containsKey(piece.part)) return;
    if (!version.parts.isEmpty() && version.parts.firstEntry().getValue().numParts != piece.numParts) return;
    version.parts.put(piece.part, piece);
    held += size(piece);
    int keep = version.parts.containsKey(0) ? at + 1 : VERSIONS;
    while (versions.size() > keep) forget(versions.remove(versions.size() - 1));
    ++changes;
  }

  private void forget(Version version) {
    for (Piece piece : version.parts.values()) held -= size(piece);
  }

  /** Grows whenever something new was heard. */
  public synchronized long changes() { return changes; }

  public synchronized List<Integer> robots() { return new ArrayList<>(robots.keySet()); }

  private List<List<Piece>> of(int number, Piece.Kind kind) {
    List<List<Piece>> found = new ArrayList<>();
    Robot robot = robots.get(number);
    if (robot == null) return found;
    for (Map.Entry<List<Object>, List<Version>> entry : robot.pieces.entrySet()) {
      if (entry.getKey().get(0) != kind) continue;
      for (Version version : entry.getValue()) {
        if (!version.parts.containsKey(0)) continue;
        found.add(new ArrayList<>(version.parts.values()));
        break;
      }
    }
    return found;
  }

  /** {x, y, z} -> {topic, microseconds when it was seen, certainty in steps of 1/63} of a robot's own map. */
  public synchronized Map<List<Integer>, long[]> cells(int robot) {
    Map<List<Integer>, Long> certainties = new HashMap<>();
    for (List<Piece> parts : of(robot, Piece.Kind.CERTAINTIES))
      for (Piece piece : parts)
        for (int i = 0; i < piece.values.length; ++i) certainties.put(cell(piece, i), piece.values[i]);
    Map<List<Integer>, long[]> cells = new HashMap<>();
    for (List<Piece> parts : of(robot, Piece.Kind.LABELS)) {
      for (Piece piece : parts) {
        for (int i = 0; i < piece.values.length; ++i) {
          List<Integer> cell = cell(piece, i);
          long[] known = cells.get(cell);
          if (known != null && known[1] >= piece.seen[i]) continue;
          cells.put(cell, new long[] {piece.values[i], piece.seen[i], certainties.getOrDefault(cell, 0L)});
        }
      }
    }
    return cells;
  }

  private static List<Integer> cell(Piece piece, int i) {
    int[] at = piece.cells.get(i);
    return Arrays.asList(at[0], at[1], at[2]);
  }

  /** A robot's topics by id, each as a piece that has the words of all parts; without retired ones. */
  public synchronized TreeMap<Integer, Piece> topics(int robot) {
    TreeMap<Integer, Piece> topics = new TreeMap<>();
    for (List<Piece> parts : of(robot, Piece.Kind.TOPIC)) {
      if (parts.get(0).weight == 0) continue;
      Piece topic = new Piece();
      topic.index = parts.get(0).index;
      topic.weight = parts.get(0).weight;
      topic.groups = parts.get(0).groups;
      for (Piece part : parts) {
        if (!Arrays.equals(part.groups, topic.groups)) continue;
        for (Map.Entry<Integer, Integer> word : part.words.entrySet())
          topic.words.merge(word.getKey(), word.getValue(), Math::min);
      }
      topics.put(topic.index.get(0), topic);
    }
    return topics;
  }
}
