// SPDX-License-Identifier: BSD-3-Clause
package shoal.spy;

import java.util.Arrays;
import java.util.HashMap;

/** Probabilities of several contexts, mixed into one, as docs/wire.md defines. Integers only. */
final class BitMixer {
  /** {P(1) x 65536, bits seen} per context; begin as {32768, 0} when first used. */
  static final class Contexts {
    private final HashMap<Long, int[]> contexts = new HashMap<>();

    int[] get(long key) { return contexts.computeIfAbsent(key, k -> new int[] {32768, 0}); }
  }

  private static final int MOST = 2047;
  private static final int[] SQUASH = {22,    36,    60,    98,    162,   267,   439,   720,   1179,  1921,  3108,
                                       4971,  7812,  11955, 17625, 24743, 32768, 40793, 47911, 53581, 57724, 60565,
                                       62428, 63615, 64357, 64816, 65097, 65269, 65374, 65438, 65476, 65500, 65514};
  private static final int[] BELIEF = {0, 110, 160, 190, 210, 225, 236, 245};
  private static final int[] STRETCH = new int[4096];

  static {
    int odds = -MOST;
    for (int p = 0; p < STRETCH.length; ++p) {
      while (odds < MOST && squash(odds) < 16 * p + 8) ++odds;
      STRETCH[p] = odds;
    }
  }

  private final int count;
  private final HashMap<Integer, long[]> sets = new HashMap<>();

  BitMixer(int count) { this.count = count; }

  private static long clamp(long value, long low, long high) { return Math.max(low, Math.min(high, value)); }

  private static int squash(long odds) {
    int shifted = (int) clamp(odds, -MOST, MOST) + 2048;
    int i = shifted >> 7, rest = shifted & 127;
    return (SQUASH[i] * (128 - rest) + SQUASH[i + 1] * rest + 64) >> 7;
  }

  int bit(BitReader bits, int[][] contexts, int which) throws BadMessage {
    long[] weights = sets.computeIfAbsent(which, k -> {
      long[] made = new long[count];
      Arrays.fill(made, 14336);
      return made;
    });
    long[] odds = new long[count];
    long total = 0;
    for (int k = 0; k < count; ++k) {
      int belief = contexts[k][1] < BELIEF.length ? BELIEF[contexts[k][1]] : 256;
      odds[k] = STRETCH[contexts[k][0] >> 4] * belief / 256;
      total += weights[k] * odds[k];
    }
    int one = squash(clamp(total / 65536, -MOST, MOST));
    int bit = bits.plain(65536 - (int) clamp(one, 32, 65504));
    long error = (bit == 1 ? 65536 : 0) - one;
    for (int k = 0; k < count; ++k) {
      weights[k] += odds[k] * error / (1 << 15);
      int[] context = contexts[k];
      context[0] += ((bit == 1 ? 65535 : 0) - context[0]) * 2 / (2 * context[1] + 3);
      if (context[1] < 250) ++context[1];
    }
    return bit;
  }
}
