// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shoal/random.h"
#include "shoal/vision/binary_word.h"

namespace shoal::vision {

inline void appendLittleEndian64(std::vector<uint8_t>& bytes, uint64_t value) {
  for (int i = 0; i < 8; ++i) bytes.push_back(static_cast<uint8_t>(value >> (8 * i)));
}

/// Over the whole 8-byte blocks of `bytes`. A chain of bijections: a change within one block changes it for
/// certain.
inline uint64_t checksum(std::span<const uint8_t> bytes) {
  uint64_t hash = 0;
  for (size_t i = 0; i + 8 <= bytes.size(); i += 8) hash = hashCombine(hash, littleEndian64(&bytes[i]));
  return hash;
}

}  // namespace shoal::vision
