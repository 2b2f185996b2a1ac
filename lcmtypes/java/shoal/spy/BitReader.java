// SPDX-License-Identifier: BSD-3-Clause
package shoal.spy;

import static shoal.spy.BadMessage.require;

import java.util.HashMap;

/** The range coder of docs/wire.md, and the numbers made of its bits. Refuses to read past what an encoder writes. */
final class BitReader {
  /** Models of bits, {P(0) x 65536, bits seen}, that begin as {32768, 0} when first used. */
  static final class Models {
    private final HashMap<Integer, int[]> models = new HashMap<>();

    int[] get(int key) { return models.computeIfAbsent(key, k -> new int[] {32768, 0}); }
  }

  private static final int FIRST = 1000, SECOND = 2000;  // keys of numbers' upper bits, above those of lengths
  private final byte[] data;
  private int at;
  private long range = 0xFFFFFFFFL, code;

  BitReader(byte[] data) {
    this.data = data;
    for (int i = 0; i < 4; ++i) code = code << 8 | next();
  }

  private int next() {
    int byteNow = at < data.length ? data[at] & 255 : 0;
    ++at;
    return byteNow;
  }

  private void normalize() throws BadMessage {
    while (range < 1 << 24) {
      range <<= 8;
      code = (code << 8 | next()) & 0xFFFFFFFFL;
    }
    require(at - data.length <= 4, "the payload ends early");
  }

  /** One bit that is 0 with probability zero / 65536. */
  int plain(int zero) throws BadMessage {
    long bound = (range >> 16) * zero;
    int one = code < bound ? 0 : 1;
    if (one == 0) {
      range = bound;
    } else {
      code -= bound;
      range -= bound;
    }
    normalize();
    return one;
  }

  /** One bit; the model learns. */
  int bit(int[] model) throws BadMessage {
    int zero = model[0], seen = model[1];
    int one = plain(zero);
    zero += one == 1 ? -(zero * 2 / (2 * seen + 3)) : (65536 - zero) * 2 / (2 * seen + 3);
    model[0] = Math.max(32, Math.min(65504, zero));
    if (seen < 100) model[1] = seen + 1;
    return one;
  }

  long direct(int bits) throws BadMessage {
    long value = 0;
    for (int i = 0; i < bits; ++i) {
      range >>= 1;
      int one = code >= range ? 1 : 0;
      if (one == 1) code -= range;
      value = value << 1 | one;
      normalize();
    }
    return value;
  }

  long wide() throws BadMessage { return ofWidth((int) direct(6)); }

  long wideOf(Models models) throws BadMessage { return ofWidth(tree(models, 6)); }

  private long ofWidth(int width) throws BadMessage {
    return width == 0 ? 0 : 1L << (width - 1) | direct(width - 1);
  }

  int tree(Models models, int bits) throws BadMessage {
    int node = 1;
    for (int i = 0; i < bits; ++i) node = 2 * node + bit(models.get(node));
    return node - (1 << bits);
  }

  long small(Models models) throws BadMessage {
    int length = 0;
    while (length < 31 && bit(models.get(length)) == 1) ++length;
    long value = 1;
    for (int i = 0; i < length; ++i) {
      long bit = i == 0   ? bit(models.get(FIRST + length))
                 : i == 1 ? bit(models.get(SECOND + 2 * length + (int) (value & 1)))
                          : direct(1);
      value = value << 1 | bit;
    }
    return value - 1;
  }

  void end() throws BadMessage { require(at >= data.length, "bytes after the end of the payload"); }
}
