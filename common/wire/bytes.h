// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace shoal::wire {

/// An encoded message, or a payload.
using Bytes = std::vector<uint8_t>;

/// Up to eight bytes as one number, the most significant first, as LCM writes.
constexpr uint64_t bigEndian(std::span<const uint8_t> bytes) {
  uint64_t value = 0;
  for (const uint8_t byte : bytes) value = value << 8 | byte;
  return value;
}

/// Appends a number in groups of seven bits, the least significant first; a set top bit says "more follows".
void putVarint(Bytes& out, uint64_t value);

/// Appends the low `num_bytes` bytes, the most significant first.
void putBigEndian(Bytes& out, uint64_t value, int num_bytes);

/// Reads what the functions above wrote. Past the end, or on a varint above 64 bits, it fails for good and
/// returns zeros.
class ByteReader {
 public:
  explicit ByteReader(std::span<const uint8_t> bytes) : bytes_(bytes) {}

  uint64_t varint();
  uint64_t bigEndian(int num_bytes);
  /// The next bytes as they are, seen in place; none of them when there are not so many.
  std::span<const uint8_t> take(uint64_t num_bytes);

  size_t remaining() const { return bytes_.size(); }
  bool failed() const { return failed_; }

 private:
  uint8_t next();
  std::span<const uint8_t> bytes_;
  bool failed_ = false;
};

}  // namespace shoal::wire
