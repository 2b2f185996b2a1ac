// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "shoal/wire/range_coder.h"

namespace shoal::wire {

/// A number below 2^63 whose size nobody can guess: its bit width (6 bits), then the bits below the leading
/// one.
template <typename Coder>
uint64_t codeWide(Coder& coder, uint64_t value) {
  const int width = static_cast<int>(coder.direct(static_cast<uint64_t>(std::bit_width(value)), 6));
  if (width == 0) return 0;
  const uint64_t leading = uint64_t{1} << (width - 1);
  return leading | coder.direct(value & (leading - 1), width - 1);
}

/// Numbers in [0, 2^bits), no order assumed: a binary tree of adaptive bits, most significant first.
class BitTree {
 public:
  explicit BitTree(int bits) : bits_(bits), nodes_(size_t{1} << bits) {}

  template <typename Coder>
  uint32_t code(Coder& coder, uint32_t value) {
    size_t node = 1;
    for (int i = bits_ - 1; i >= 0; --i) {
      node = node << 1 | static_cast<size_t>(coder.bit(nodes_[node], static_cast<int>(value >> i & 1)));
    }
    return static_cast<uint32_t>(node - (size_t{1} << bits_));
  }

 private:
  int bits_;
  std::vector<AdaptiveBit> nodes_;  // [0] unused
};

/// Numbers in [0, 2^31), mostly small: Exp-Golomb of value + 1 with its length in unary and its two highest
/// bits below the leading one adaptive.
class SmallNumber {
 public:
  SmallNumber() = default;

  /// Starts from the belief that P(value = 0) = zero / 65536, worth `seen` observations.
  SmallNumber(uint16_t zero, uint8_t seen) { length_[0] = {zero, seen}; }

  template <typename Coder>
  uint32_t code(Coder& coder, uint32_t value) {
    const uint32_t plus_one = value + 1;
    const int length = static_cast<int>(std::bit_width(plus_one)) - 1;
    int read = 0;
    while (read < kMaxLength && coder.bit(length_[static_cast<size_t>(read)], read < length ? 1 : 0) != 0)
      ++read;
    uint32_t result = 1;
    for (int i = read - 1; i >= 0; --i) {
      const uint32_t bit = plus_one >> i & 1;
      const int below = read - 1 - i;  // bits already coded below the leading one
      if (below < 2) {
        AdaptiveBit& model = high_[static_cast<size_t>(read)][below == 0 ? 0 : 1 + (result & 1)];
        result = result << 1 | static_cast<uint32_t>(coder.bit(model, static_cast<int>(bit)));
      } else {
        result = result << 1 | static_cast<uint32_t>(coder.direct(bit, 1));
      }
    }
    return result - 1;
  }

 private:
  static constexpr int kMaxLength = 31;
  std::array<AdaptiveBit, kMaxLength> length_;
  std::array<std::array<AdaptiveBit, 3>, kMaxLength + 1> high_;
};

/// Numbers below 2^63 of which many have the same size: adaptive bit width, then the bits below the leading
/// one.
class LongNumber {
 public:
  template <typename Coder>
  uint64_t code(Coder& coder, uint64_t value) {
    const uint32_t width = width_.code(coder, static_cast<uint32_t>(std::bit_width(value)));
    if (width == 0) return 0;
    const uint64_t leading = uint64_t{1} << (width - 1);
    return leading | coder.direct(value & (leading - 1), static_cast<int>(width) - 1);
  }

 private:
  BitTree width_{6};
};

/// Signed to unsigned: 0, -1, 1, -2, ... become 0, 1, 2, 3, ...
constexpr uint32_t zigzag(int32_t value) {
  return static_cast<uint32_t>(value) << 1 ^ static_cast<uint32_t>(value >> 31);
}
constexpr int32_t unzigzag(uint32_t value) { return static_cast<int32_t>(value >> 1 ^ (0 - (value & 1))); }

}  // namespace shoal::wire
