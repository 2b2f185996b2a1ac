// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string_view>

#include "shoal/random.h"

namespace shoal {

/// Of a text's length and bytes, the same on every machine. Not cryptographic.
constexpr uint64_t hashText(std::string_view text) {
  uint64_t hash = text.size();
  for (const char c : text) hash = hashCombine(hash, static_cast<uint8_t>(c));
  return hash;
}

}  // namespace shoal
