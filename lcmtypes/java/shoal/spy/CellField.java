// SPDX-License-Identifier: BSD-3-Clause
package shoal.spy;

import java.util.ArrayList;
import java.util.HashMap;
import java.util.List;

/** Which cells a message speaks of, and what each has around it that came before: docs/wire.md. */
final class CellField {
  /** Columns in whose cells a cell looks for its like, nearest first: dx, dy, weight. */
  private static final int[][] COLUMNS = {
      {-1, 0, 16}, {0, -1, 16}, {-1, -1, 9}, {-1, 1, 9}, {1, -1, 9}, {-2, 0, 5}, {0, -2, 5}, {-2, -1, 4}, {-1, -2, 4},
      {-2, 1, 4},  {-1, 2, 4},  {1, -2, 4},  {2, -1, 4}, {-2, -2, 3}, {-2, 2, 3}, {2, -2, 3}, {-3, 0, 2}, {0, -3, 2}};
  static final int PLACES = COLUMNS.length + 1;
  private static final int MAX_ASKED = 131072;  // of a message

  final List<int[]> cells = new ArrayList<>();  // x, y, z
  final List<int[]> near = new ArrayList<>();   // PLACES indices into cells, -1 where there is none
  private final HashMap<Long, List<int[]>> columns = new HashMap<>();  // (x, y) -> {z, place}, ascending
  private int asked = 0;  // places, so far: is there a cell?
  private final BitReader.Models lowest = new BitReader.Models(), highest = new BitReader.Models();
  private final int[][] alike = new int[64][];
  private final BitMixer.Contexts heights = new BitMixer.Contexts(), diagonals = new BitMixer.Contexts(),
                                  corners = new BitMixer.Contexts(), lines = new BitMixer.Contexts(),
                                  slopes = new BitMixer.Contexts(), patterns = new BitMixer.Contexts();
  private final BitMixer mixer = new BitMixer(7);

  CellField() {
    int[] begin = {2000, 26000, 50000, 63500};
    for (int c = 0; c < alike.length; ++c) alike[c] = new int[] {begin[Integer.bitCount(c & 7)], 3};
  }

  static int weight(int place) { return place < COLUMNS.length ? COLUMNS[place][2] : 16; }

  private static long key(int x, int y) { return (long) x << 32 | y & 0xFFFFFFFFL; }

  /** {height, place} of the cell of a column nearest to z, the lower of two; null when it is empty. */
  private int[] nearest(int x, int y, int z) {
    List<int[]> column = columns.get(key(x, y));
    if (column == null) return null;
    int[] best = null;
    for (int i = column.size() - 1; i >= 0; --i) {
      int[] cell = column.get(i);
      if (best != null && Math.abs(cell[0] - z) > Math.abs(best[0] - z)) break;
      best = cell;
    }
    return best;
  }

  /**
   * How each cell lies: steps to the heights west and south, from 0 to 5, then how many cells of its column are above and
   * below, at most 2 of each.
   */
  int[][] lies() {
    int[][] lies = new int[cells.size()][];
    for (List<int[]> column : columns.values()) {
      for (int below = 0; below < column.size(); ++below) {
        int place = column.get(below)[1], above = column.size() - 1 - below;
        int[] around = near.get(place);
        lies[place] = new int[] {lie(around[0], place), lie(around[1], place), Math.min(above, 2), Math.min(below, 2)};
      }
    }
    return lies;
  }

  private int lie(int other, int place) {
    return other < 0 ? 0 : Math.min(Math.max(cells.get(other)[2] - cells.get(place)[2], -2), 2) + 3;
  }

  private boolean has(int x, int y, int z) {
    int[] found = nearest(x, y, z);
    return found != null && found[0] == z;
  }

  private static int step(int[] found, int z) {
    return found == null ? 0 : Math.min(Math.max(found[0] - z, -3), 3) + 4;
  }

  /** Where a line or a plane leads, seen from z. */
  private static int trend(int[] seen, int[] onward, int[] back, int z) {
    if (seen == null || onward == null || back == null) return 0;
    return Math.min(Math.max(seen[0] + onward[0] - back[0] - z, -4), 3) + 5;
  }

  private int pattern(int x, int y, int z) {
    return (has(x, y, z - 1) ? 1 : 0) | (has(x, y, z) ? 2 : 0) | (has(x, y, z + 1) ? 4 : 0);
  }

  private void add(int x, int y, int z) {
    int[] around = new int[PLACES];
    for (int i = 0; i < COLUMNS.length; ++i) {
      int[] found = nearest(x + COLUMNS[i][0], y + COLUMNS[i][1], z);
      around[i] = found == null ? -1 : found[1];
    }
    List<int[]> own = columns.computeIfAbsent(key(x, y), k -> new ArrayList<>());
    int[] top = own.isEmpty() ? null : own.get(own.size() - 1);
    around[COLUMNS.length] = top != null && top[0] == z - 1 ? top[1] : -1;
    own.add(new int[] {z, cells.size()});
    cells.add(new int[] {x, y, z});
    near.add(around);
  }

  /** Adds the cells of the brick with these indices. */
  void readBrick(BitReader bits, int brickX, int brickY, int brickZ) throws BadMessage {
    int low = bits.tree(lowest, 4), high = bits.tree(highest, 4);
    asked += 256 * Math.max(high - low + 1, 0);
    BadMessage.require(asked <= MAX_ASKED, "places for cells");
    int x0 = 16 * brickX, y0 = 16 * brickY, z0 = 16 * brickZ;
    for (int x = x0; x < x0 + 16; ++x) {
      for (int y = y0; y < y0 + 16; ++y) {
        int began = 0, state = has(x, y, z0 + low - 1) ? 1 : 0;
        boolean alone = !columns.containsKey(key(x, y - 1)) && !columns.containsKey(key(x - 1, y));
        for (int z = z0 + low; z <= z0 + high; ++z) {
          if (mixer.bit(bits, contexts(x, y, z, began, state), (alone ? 3 : 0) + state) == 1) {
            add(x, y, z);
            began = state = 1;
          } else if (state == 1) {
            state = 2;
          }
        }
      }
    }
  }

  private int[][] contexts(int x, int y, int z, int began, int state) {
    int[] westOf = nearest(x - 1, y, z), southOf = nearest(x, y - 1, z), southwestOf = nearest(x - 1, y - 1, z);
    int[] west2 = nearest(x - 2, y, z), south2 = nearest(x, y - 2, z);
    int west = step(westOf, z), south = step(southOf, z);
    int southwest = step(southwestOf, z), northwest = step(nearest(x - 1, y + 1, z), z);
    int same = (west == 4 ? 1 : 0) | (south == 4 ? 2 : 0) | (southwest == 4 ? 4 : 0) | (west > 4 ? 8 : 0) |
               (south > 4 ? 16 : 0) | began << 5;
    int both = west * 8 + south, diagonal = southwest * 8 + northwest;
    int trends = (trend(westOf, southOf, southwestOf, z) * 9 + trend(westOf, westOf, west2, z)) * 9 +
                 trend(southOf, southOf, south2, z);
    int pattern = pattern(x - 1, y, z) | pattern(x, y - 1, z) << 3 | pattern(x - 1, y - 1, z) << 6 |
                  pattern(x - 1, y + 1, z) << 9;
    return new int[][] {alike[same], heights.get(both * 3 + state), diagonals.get((diagonal * 8 + west) * 3 + state),
                        corners.get((both * 64 + diagonal) * 3 + state),
                        lines.get((both * 64 + step(west2, z) * 8 + step(south2, z)) * 3 + state),
                        slopes.get(trends * 3 + state), patterns.get(pattern * 3 + state)};
  }
}
