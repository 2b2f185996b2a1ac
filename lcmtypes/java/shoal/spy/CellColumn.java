// SPDX-License-Identifier: BSD-3-Clause
package shoal.spy;

import static shoal.spy.BadMessage.require;

import java.util.ArrayList;
import java.util.List;

/** A column of values over the cells of a message: a palette, then an index into it for each cell (docs/wire.md). */
final class CellColumn {
  private static final int[][] RANKS = {{12000, 3350}, {6000, 3300}, {6000, 3000}, {6000, 3000}};

  private final BitReader bits;
  private final int[][] shares = new int[4 * 16 * 4][];
  private final BitMixer.Contexts inner = new BitMixer.Contexts(), names = new BitMixer.Contexts(),
                                  rings = new BitMixer.Contexts(), surprised = new BitMixer.Contexts(),
                                  forms = new BitMixer.Contexts(), levels = new BitMixer.Contexts();
  private final BitMixer mixer = new BitMixer(7);

  private CellColumn(BitReader bits) {
    this.bits = bits;
    for (int rank = 0; rank < 4; ++rank)
      for (int share = 0; share < 16; ++share)
        for (int known = 0; known < 4; ++known)
          shares[(rank * 16 + share) * 4 + known] = new int[] {RANKS[rank][0] + share * RANKS[rank][1], 2};
  }

  /** One value a cell, each in [0, limit]. */
  static long[] read(BitReader bits, CellField field, long limit, int mostNames, boolean ordered) throws BadMessage {
    long[] palette = palette(bits, limit, mostNames);
    long[] values = new long[field.cells.size()];
    int[] which = palette.length == 1 ? new int[values.length] : new CellColumn(bits).indices(field, palette.length, ordered);
    for (int i = 0; i < values.length; ++i) values[i] = palette[which[i]];
    return values;
  }

  private static long[] palette(BitReader bits, long limit, int most) throws BadMessage {
    long size = bits.wide();
    require(1 <= size && size <= most, "size of a palette");
    BitReader.Models models = new BitReader.Models();
    long[] values = new long[(int) size];
    long follows = 0;
    for (int i = 0; i < values.length; ++i) {
      values[i] = follows + bits.wideOf(models);
      require(follows <= values[i] && values[i] <= limit, "a value of a palette");
      follows = values[i] + 1;
    }
    return values;
  }

  private static int base3(int[] relation, int... places) {
    int value = 0;
    for (int place : places) value = 3 * value + relation[place];
    return value;
  }

  /** Is it the candidate of this rank? */
  private boolean ask(List<int[]> candidates, int allVotes, int rank, int left, int[] near, int surprises, int level,
                      int[] lie) throws BadMessage {
    int asked = candidates.get(rank)[0], votes = candidates.get(rank)[1];
    int share = Math.min(15, votes * 16 / left), known = Math.min(3, allVotes / 30);
    int[] relation = new int[near.length];
    for (int i = 0; i < near.length; ++i) relation[i] = near[i] < 0 ? 0 : near[i] == asked ? 2 : 1;
    int nearest = base3(relation, 0, 1, 2, 3), second = base3(relation, 4, 5, 6, 18);
    int ring = base3(relation, 7, 8, 9, 10), label = Math.min(asked, 31), stack = lie[2] * 3 + lie[3];
    int[][] contexts = {shares[(rank * 16 + share) * 4 + known],
                        inner.get((rank * 81 + nearest) * 81 + second),
                        names.get((label * 81 + nearest) * 4 + rank),
                        rings.get((rank * 81 + ring) * 81 + nearest),
                        surprised.get(((rank * 16 + share) * 4 + surprises) * 4 + Math.min(3, candidates.size())),
                        forms.get((((label * 6 + lie[0]) * 6 + lie[1]) * 9 + stack) * 9 + base3(relation, 0, 1)),
                        levels.get(((label * 64 + level) * 9 + stack) * 9 + base3(relation, 18, 0))};
    return mixer.bit(bits, contexts, rank * 4 + share / 4) == 1;
  }

  /** {value, votes} of what the cells around say, best first, the earlier of equals first. */
  private static List<int[]> votes(int[] near) {
    List<int[]> found = new ArrayList<>();
    for (int place = 0; place < near.length; ++place) {
      if (near[place] < 0) continue;
      int[] known = null;
      for (int[] one : found)
        if (one[0] == near[place]) known = one;
      if (known == null) found.add(known = new int[] {near[place], 0});
      known[1] += CellField.weight(place);
    }
    found.sort((a, b) -> b[1] - a[1]);
    return found;
  }

  private int[] indices(CellField field, int size, boolean ordered) throws BadMessage {
    int[] result = new int[field.near.size()], order = new int[size], placeOf = new int[size], seen = new int[size];
    for (int i = 0; i < size; ++i) order[i] = placeOf[i] = i;
    boolean[] surprise = new boolean[result.length];
    BitReader.Models hits = new BitReader.Models(), distance = new BitReader.Models();
    int[] after = {32768, 0};
    long last = 0;
    int[][] lies = field.lies();
    for (int cell = 0; cell < result.length; ++cell) {
      int[] places = field.near.get(cell), near = new int[places.length];
      for (int i = 0; i < near.length; ++i) near[i] = places[i] < 0 ? -1 : result[places[i]];
      List<int[]> candidates = votes(near);
      int allVotes = 0;
      for (int[] one : candidates) allVotes += one[1];
      if (candidates.size() > 4) candidates = candidates.subList(0, 4);
      int surprises = 0;
      for (int i = 0; i < 2; ++i)
        if (places[i] >= 0 && surprise[places[i]]) surprises |= 1 << i;
      long value = -1;
      boolean known = false;
      int left = allVotes, asked = 0;
      for (int rank = 0; rank < candidates.size() && !known; ++rank) {
        asked = rank;
        known = ask(candidates, allVotes, rank, left, near, surprises, field.cells.get(cell)[2] & 63, lies[cell]);
        if (known) value = candidates.get(rank)[0];
        left = Math.max(1, left - candidates.get(rank)[1]);
      }
      surprise[cell] = !candidates.isEmpty() && (asked > 0 || !known);
      if (!known && ordered) {
        long origin = candidates.isEmpty() ? last : candidates.get(0)[0];
        int up = bits.bit(after);
        long step = bits.small(distance) + (candidates.isEmpty() ? 0 : 1);
        value = up == 1 ? origin + step : origin - step;
      } else if (!known) {
        value = unlikely(order, candidates, hits);
      }
      require(0 <= value && value < size, "an index into a palette");
      result[cell] = (int) value;
      last = value;
      if (!ordered) rise(order, placeOf, seen, (int) value);
    }
    return result;
  }

  /** A value that no candidate is: asked for one by one, the most frequent first. */
  private int unlikely(int[] order, List<int[]> candidates, BitReader.Models hits) throws BadMessage {
    int end = order.length - 1;
    while (end >= 0 && isCandidate(candidates, order[end])) --end;
    require(end >= 0, "every name is ruled out");
    int asked = 0;
    for (int i = 0; i < end; ++i) {
      if (isCandidate(candidates, order[i])) continue;
      if (bits.bit(hits.get(Math.min(asked, 23))) == 1) return order[i];
      ++asked;
    }
    return order[end];
  }

  private static boolean isCandidate(List<int[]> candidates, int value) {
    for (int[] one : candidates)
      if (one[0] == value) return true;
    return false;
  }

  private static void rise(int[] order, int[] placeOf, int[] seen, int value) {
    ++seen[value];
    int at = placeOf[value];
    for (; at > 0 && seen[order[at - 1]] < seen[value]; --at) {
      order[at] = order[at - 1];
      placeOf[order[at]] = at;
    }
    order[at] = value;
    placeOf[value] = at;
  }
}
