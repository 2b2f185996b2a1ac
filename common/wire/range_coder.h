// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "shoal/wire/bytes.h"

namespace shoal::wire {

/// An estimate, learned from the bits themselves, of how likely the next bit is 0. Integers only, so that
/// every machine computes the same.
struct AdaptiveBit {
  uint16_t zero = 1u << 15;  ///< P(0) x 65536, in [kMargin, 65536 - kMargin]
  uint8_t seen = 0;          ///< how much the estimate weighs: bits seen, at most kMemory

  static constexpr int kMargin = 32;
  static constexpr int kMemory = 100;

  /// Moves 1 / (seen + 1.5) of the way to the bit just seen.
  void update(int bit) {
    const int32_t target = bit != 0 ? 0 : 65536;
    const int32_t moved = zero + (target - zero) * 2 / (2 * seen + 3);
    zero = static_cast<uint16_t>(moved < kMargin           ? kMargin
                                 : moved > 65536 - kMargin ? 65536 - kMargin
                                                           : moved);
    if (seen < kMemory) ++seen;
  }
};

/// Writes bits at the cost of their surprise. The carry-propagating range coder of LZMA (I. Pavlov, LZMA
/// specification 2015), with 16-bit probabilities, without its constant first byte and with an end cut to
/// the fewest bytes that decide.
///
/// Codec functions are templates over Encoder and Decoder: bit() takes the bit and returns it from an
/// Encoder, ignores it and returns the one read from a Decoder. One text, both directions.
class Encoder {
 public:
  static constexpr bool kReads = false;

  int bit(AdaptiveBit& model, int value);

  /// A bit that is 0 with probability zero / 65536, 0 < zero < 65536.
  int bit(uint32_t zero, int value);

  /// The low `bits` bits of `value`, each at the price of one bit. 0 <= bits <= 63.
  uint64_t direct(uint64_t value, int bits);

  static constexpr bool overrun() { return false; }

  /// Ends the stream. Nothing may be coded afterwards.
  Bytes finish();

 private:
  void shiftLow();
  void normalize();
  Bytes out_;
  uint64_t low_ = 0;
  uint32_t range_ = 0xffffffffu;
  uint8_t cache_ = 0;
  size_t pending_ = 1;  // bytes that a carry could still change; the first of all is never written
  bool first_ = true;
};

/// Reads what Encoder wrote. Past the end it reads zeros: it never fails, but see overrun().
class Decoder {
 public:
  static constexpr bool kReads = true;

  explicit Decoder(std::span<const uint8_t> bytes);

  int bit(AdaptiveBit& model, int ignored = 0);
  int bit(uint32_t zero, int ignored = 0);
  uint64_t direct(uint64_t ignored, int bits);

  /// True once it has read further than any Encoder's stream goes on: the rest is invented. Loops stop here.
  bool overrun() const { return past_end_ > 4; }

 private:
  void normalize();
  uint8_t next();
  std::span<const uint8_t> bytes_;
  size_t position_ = 0;
  size_t past_end_ = 0;
  uint32_t code_ = 0;
  uint32_t range_ = 0xffffffffu;
};

}  // namespace shoal::wire
