// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace shoal::console {

/// Reads values of plain CDR (OMG DDSI-RTPS 2.2, 10.2), as ROS 2 serialises messages: four bytes that say the
/// byte order, then values aligned to their size. Any bytes may come: reading past the end gives zeros and
/// makes good() false for ever. Views into the bytes, which outlive it.
class CdrReader {
 public:
  explicit CdrReader(std::span<const uint8_t> bytes);

  bool good() const { return good_; }

  uint8_t u8();
  uint32_t u32();
  int32_t i32() { return static_cast<int32_t>(u32()); }
  double f64();
  /// At most kMaxString bytes.
  std::string string();
  /// A sequence of bytes.
  std::span<const uint8_t> bytes();
  /// Passes a sequence of doubles over; returns whether any of them is not 0.
  bool anyOfDoubles();

  static constexpr size_t kMaxString = 4096;

 private:
  std::span<const uint8_t> take(size_t size, size_t alignment);
  uint64_t number(size_t size);

  std::span<const uint8_t> body_;
  size_t at_ = 0;
  bool is_big_ = false, good_ = true;
};

}  // namespace shoal::console
