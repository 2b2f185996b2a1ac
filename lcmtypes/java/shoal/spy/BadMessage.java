// SPDX-License-Identifier: BSD-3-Clause
package shoal.spy;

/** Why the bytes of a message were refused. */
public class BadMessage extends Exception {
  public BadMessage(String reason) { super(reason); }

  static void require(boolean condition, String what) throws BadMessage {
    if (!condition) throw new BadMessage(what);
  }
}
