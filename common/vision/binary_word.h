// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace shoal::vision {

/// A 256-bit descriptor. Byte b of the descriptor is bits 8·(b mod 8)… of element b / 8.
using BinaryWord = std::array<uint64_t, 4>;

inline constexpr size_t kBinaryWordBytes = 32;
inline constexpr int kBinaryWordBits = 256;

/// Eight bytes as a little-endian number, on any machine.
inline uint64_t littleEndian64(const uint8_t* bytes) {
  uint64_t value = 0;
  for (int i = 7; i >= 0; --i) value = (value << 8) | bytes[i];
  return value;
}

/// The word of 32 descriptor bytes.
inline BinaryWord binaryWord(const uint8_t* bytes) {
  return {littleEndian64(bytes), littleEndian64(bytes + 8), littleEndian64(bytes + 16),
          littleEndian64(bytes + 24)};
}

/// Number of unlike bits, in [0, 256].
inline int hammingDistance(const BinaryWord& a, const BinaryWord& b) {
  return std::popcount(a[0] ^ b[0]) + std::popcount(a[1] ^ b[1]) + std::popcount(a[2] ^ b[2]) +
         std::popcount(a[3] ^ b[3]);
}

}  // namespace shoal::vision
