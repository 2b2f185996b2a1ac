// SPDX-License-Identifier: BSD-3-Clause
package shoal.spy;

import static shoal.spy.BadMessage.require;

import java.nio.ByteBuffer;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.List;
import java.util.TreeMap;
import shoal.bricks_t;
import shoal.certainties_t;
import shoal.repair_t;
import shoal.topics_t;

/** A part of a robot's state, as a message told it: of a topic, of a brick's labels, or of its certainties. */
public final class Piece {
  public enum Kind { TOPIC, LABELS, CERTAINTIES }

  public Kind kind;
  public int robot, epoch, observation, part, numParts;
  public List<Integer> index = new ArrayList<>();  // the topic, or the brick's x, y, z
  public List<int[]> cells = new ArrayList<>();    // x, y, z
  public long[] values = {};                       // of the cells: topics, or certainties in steps of 1/63
  public long[] seen = {};                         // LABELS: microseconds of mission time
  public long weight;                              // TOPIC: 0 when it is retired
  public int[] groups = {};                        // TOPIC: words in each word group
  public TreeMap<Integer, Integer> words = new TreeMap<>();  // TOPIC: word -> count

  private static final int MAX_MESSAGE = 1391, MAX_CELLS = 32768, MAX_TOPIC = 9999, MAX_WORDS = 65536,
                           MAX_TOPICS = 256, STEPS = 63, FRONT = 21, SEAL = 16;
  private static final long MAX_TIME = (1L << 62) - 1;

  /** Whether messages of this fingerprint hold what this reads. */
  public static boolean canRead(long fingerprint) {
    return fingerprint == repair_t.LCM_FINGERPRINT || sizeOfFields(fingerprint) > 0;
  }

  private static int sizeOfFields(long fingerprint) {
    return fingerprint == topics_t.LCM_FINGERPRINT                                                     ? 18
           : fingerprint == bricks_t.LCM_FINGERPRINT || fingerprint == certainties_t.LCM_FINGERPRINT ? 8
                                                                                                     : -1;
  }

  /** The pieces in a message, sealed or not. BadMessage when the bytes are anything else, whatever they are. */
  public static List<Piece> read(byte[] message) throws BadMessage {
    require(message.length <= MAX_MESSAGE + SEAL && message.length >= FRONT + 6, "length");
    long fingerprint = ByteBuffer.wrap(message).getLong();
    boolean again = fingerprint == repair_t.LCM_FINGERPRINT;
    int fields = again ? 1 : sizeOfFields(fingerprint);
    require(fields > 0, "a type that is not read here");
    ByteBuffer in = ByteBuffer.wrap(message);
    int head = FRONT + fields + 6;
    require(message.length >= head, "too short");
    int n = in.getInt(head - 4);
    require(n == message.length - head || n == message.length - head - SEAL, "n");
    require(n >= 0 && head + n <= MAX_MESSAGE, "n");
    require(in.getLong(8) >= 0 && message[20] == 3, "time or format");
    require(checksum(message, head, n) == (in.getShort(head - 6) & 0xFFFF), "checksum");
    byte[] payload = Arrays.copyOfRange(message, head, head + n);
    if (!again) return contents(fingerprint, ByteBuffer.wrap(message, FRONT, fields), payload);
    int kind = message[FRONT];
    long said = kind == 1   ? topics_t.LCM_FINGERPRINT
                : kind == 2 ? bricks_t.LCM_FINGERPRINT
                : kind == 3 ? certainties_t.LCM_FINGERPRINT
                            : 0;
    fields = sizeOfFields(said);
    require(0 < fields && fields <= payload.length, "a kind of piece that is not read here");
    return contents(said, ByteBuffer.wrap(payload), Arrays.copyOfRange(payload, fields, payload.length));
  }

  /** CRC-16 (CCITT, begun with all ones) of the message with its checksum 0. */
  private static int checksum(byte[] message, int head, int n) {
    int crc = 0xFFFF;
    for (int i = 0; i < head + n; ++i) {
      crc ^= (i == head - 6 || i == head - 5 ? 0 : message[i] & 255) << 8;
      for (int bit = 0; bit < 8; ++bit) crc = (crc << 1 ^ ((crc & 0x8000) != 0 ? 0x1021 : 0)) & 0xFFFF;
    }
    return crc;
  }

  private static List<Piece> contents(long fingerprint, ByteBuffer in, byte[] payload) throws BadMessage {
    List<Piece> pieces = new ArrayList<>();
    if (fingerprint == topics_t.LCM_FINGERPRINT) {
      pieces.addAll(topics(in, new BitReader(payload)));
    } else {
      Kind kind = fingerprint == bricks_t.LCM_FINGERPRINT ? Kind.LABELS : Kind.CERTAINTIES;
      pieces.addAll(bricks(kind, in.getShort(), in.getInt(), in.getShort(), new BitReader(payload)));
    }
    for (Piece piece : pieces)
      require(0 <= piece.robot && piece.robot <= 9999 && piece.epoch >= 0 && piece.observation >= 0 &&
              piece.part < piece.numParts, "robot, version or part");
    return pieces;
  }

  private static List<Piece> topics(ByteBuffer in, BitReader bits) throws BadMessage {
    Piece first = new Piece();
    first.kind = Kind.TOPIC;
    first.part = in.get() & 255;
    first.numParts = in.get() & 255;
    first.robot = in.getShort();
    first.epoch = in.getInt();
    first.observation = in.getInt();
    int topic = in.getShort();
    long numWords = in.getInt();
    require(0 <= topic && topic <= MAX_TOPIC && 0 <= numWords, "topic or num_words");
    first.index.add(topic);
    List<Piece> pieces = new ArrayList<>(Arrays.asList(first));
    List<Long> lengths = new ArrayList<>(Arrays.asList(numWords));
    moreTopics(bits, pieces, lengths);
    int[] groups = new int[(int) bits.direct(6) + 1];
    long[] ends = new long[groups.length];
    for (int g = 0; g < ends.length; ++g) {
      long size = bits.wide();
      ends[g] = size + (g == 0 ? 0 : ends[g - 1]);
      require(0 < size && size <= 1 << 20 && ends[g] <= 1 << 20, "sizes of word groups");
      groups[g] = (int) size;
    }
    long period = bits.wide();
    require(1 <= period && period <= MAX_TIME, "period of the times");
    BitReader.Models created = new BitReader.Models(), weights = new BitReader.Models(), units = new BitReader.Models();
    BitReader.Models[] gaps = new BitReader.Models[4], counts = new BitReader.Models[16];
    for (int i = 0; i < 4; ++i) gaps[i] = new BitReader.Models();
    for (int i = 0; i < 16; ++i) counts[i] = new BitReader.Models();
    for (int i = 0; i < pieces.size(); ++i) {
      Piece piece = pieces.get(i);
      long words = lengths.get(i);
      require(bits.wideOf(created) <= MAX_TIME / period, "when a topic was created");
      piece.weight = bits.wideOf(weights);
      piece.groups = groups;
      long unit = bits.wideOf(units);
      require(words <= ends[ends.length - 1] && 1 <= unit && unit < 1L << 31, "words or unit");
      require(piece.weight > 0 || words == 0, "a retired topic has no words");
      readWords(bits, piece, words, unit, ends, gaps, counts);
    }
    bits.end();
    return pieces;
  }

  /** The topics after the first: which, of what versions, with how many words. */
  private static void moreTopics(BitReader bits, List<Piece> pieces, List<Long> lengths) throws BadMessage {
    BitReader.Models ids = new BitReader.Models(), versions = new BitReader.Models(), words = new BitReader.Models();
    int[] isPart = {64000, 10};
    long more = bits.small(new BitReader.Models()), all = lengths.get(0);
    require(more < MAX_TOPICS, "topics");
    for (long i = 0; i < more; ++i) {
      Piece before = pieces.get(pieces.size() - 1), piece = new Piece();
      long topic = before.index.get(0) + 1 + bits.small(ids);
      long observation = before.observation + zigzag(bits.small(versions));
      require(topic <= MAX_TOPIC && 0 <= observation && observation <= Integer.MAX_VALUE, "topic or version");
      piece.kind = Kind.TOPIC;
      piece.robot = before.robot;
      piece.epoch = before.epoch;
      piece.observation = (int) observation;
      piece.index.add((int) topic);
      piece.numParts = 1;
      if (bits.bit(isPart) == 1) {
        piece.numParts = (int) bits.direct(8);
        piece.part = (int) bits.direct(8);
        require(piece.numParts >= 2, "parts");
      }
      long length = bits.wideOf(words);
      require(length <= MAX_WORDS, "words");
      pieces.add(piece);
      lengths.add(length);
      all += length;
    }
    require(all <= MAX_WORDS, "words");
  }

  private static void readWords(BitReader bits, Piece piece, long numWords, long unit, long[] ends, BitReader.Models[] gaps,
                                BitReader.Models[] counts) throws BadMessage {
    long follows = 0;
    int last = 0;
    for (long i = 0; i < numWords; ++i) {
      long word = follows + bits.small(gaps[group(ends, follows)]);
      long count = bits.small(counts[4 * group(ends, word) + last]);
      require(count < Integer.MAX_VALUE / unit, "a count");
      piece.words.put((int) word, (int) ((count + 1) * unit));
      follows = word + 1;
      last = Math.min(64 - Long.numberOfLeadingZeros(count), 3);
    }
  }

  private static int group(long[] ends, long word) throws BadMessage {
    require(word < ends[ends.length - 1], "a word outside the vocabulary");
    int group = 0;
    while (word >= ends[group]) ++group;
    return Math.min(group, 3);
  }

  private static long zigzag(long coded) { return (coded & 1) == 1 ? -((coded + 1) / 2) : coded / 2; }

  private static List<Piece> bricks(Kind kind, int robot, int epoch, int count, BitReader bits) throws BadMessage {
    require(1 <= count && count <= 1024, "bricks");
    List<Piece> pieces = headers(kind, robot, epoch, count, bits);
    CellField field = new CellField();
    int[] ends = new int[count];
    for (int i = 0; i < count; ++i) {
      List<Integer> brick = pieces.get(i).index;
      int begin = field.cells.size();
      field.readBrick(bits, brick.get(0), brick.get(1), brick.get(2));
      ends[i] = field.cells.size();
      require(begin < ends[i] && ends[i] <= MAX_CELLS, "cells of a brick");
    }
    long[] values, more;
    if (kind == Kind.LABELS) {
      values = CellColumn.read(bits, field, MAX_TOPIC, MAX_CELLS, false);
      long period = bits.wide();
      require(1 <= period && period <= MAX_TIME, "period of the times");
      more = CellColumn.read(bits, field, MAX_TIME / period, MAX_CELLS, true);
      for (int i = 0; i < more.length; ++i) more[i] *= period;
    } else {
      values = CellColumn.read(bits, field, STEPS, STEPS + 1, false);
      more = CellColumn.read(bits, field, STEPS, STEPS + 1, false);  // surprises: not drawn here
      for (long steps : more) require(steps == 0 || steps >= 12, "steps of surprise");
    }
    bits.end();
    for (int i = 0, begin = 0; i < count; begin = ends[i++]) {
      Piece piece = pieces.get(i);
      piece.cells = new ArrayList<>(field.cells.subList(begin, ends[i]));
      piece.values = Arrays.copyOfRange(values, begin, ends[i]);
      if (kind == Kind.LABELS) piece.seen = Arrays.copyOfRange(more, begin, ends[i]);
    }
    return pieces;
  }

  private static List<Piece> headers(Kind kind, int robot, int epoch, int count, BitReader bits) throws BadMessage {
    BitReader.Models xs = new BitReader.Models(), ys = new BitReader.Models(), rows = new BitReader.Models(),
                     above = new BitReader.Models(), zs = new BitReader.Models(), versions = new BitReader.Models();
    int[] isPart = {64000, 10};
    List<Piece> pieces = new ArrayList<>();
    long x = 0, y = 0, z = 0, rowY = 0, observation = 0;
    for (int i = 0; i < count; ++i) {
      long wasX = x, wasY = y, wasZ = z;
      if (i == 0) {
        x = zigzag(bits.wide() & 0xFFFFFFFFL);
        y = rowY = zigzag(bits.wide() & 0xFFFFFFFFL);
        z = zigzag(bits.wide() & 0xFFFFFFFFL);
        observation = bits.wide();
      } else {
        long step = bits.small(xs);
        y = step == 0 ? y + bits.small(ys) : rowY + zigzag(bits.small(rows));
        x += step;
        if (step != 0) rowY = y;
        z = step == 0 && y == wasY ? z + 1 + bits.small(above) : z + zigzag(bits.small(zs));
        observation += zigzag(bits.small(versions));
      }
      Piece piece = new Piece();
      piece.numParts = 1;
      if (bits.bit(isPart) == 1) {
        piece.numParts = (int) bits.direct(8);
        piece.part = (int) bits.direct(8);
        require(piece.numParts >= 2, "parts");
      }
      for (long index : new long[] {x, y, z}) require(-(1L << 27) <= index && index < 1L << 27, "a brick");
      require(0 <= observation && observation <= Integer.MAX_VALUE, "a version");
      require(i == 0 || wasX < x || (wasX == x && (wasY < y || (wasY == y && wasZ < z))), "the order of bricks");
      piece.kind = kind;
      piece.robot = robot;
      piece.epoch = epoch;
      piece.observation = (int) observation;
      piece.index = Arrays.asList((int) x, (int) y, (int) z);
      pieces.add(piece);
    }
    return pieces;
  }
}
