// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <string>

namespace shoal::console {

/// Appends a number, the lowest byte first.
template <std::integral Integer>
void addLittleEndian(std::string& bytes, Integer value) {
  for (size_t i = 0; i < sizeof value; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xff);
}

inline void addLittleEndian(std::string& bytes, double value) {
  addLittleEndian(bytes, std::bit_cast<uint64_t>(value));
}
inline void addLittleEndian(std::string& bytes, float value) {
  addLittleEndian(bytes, std::bit_cast<uint32_t>(value));
}

}  // namespace shoal::console
