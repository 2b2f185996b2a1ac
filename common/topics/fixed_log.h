// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "shoal/demand.h"

namespace shoal::topics {

/// Logarithms to base 2 are integers here, in units of 2^-16, and so are all sums of them. No library
/// function is used, so that every machine and compiler gets the same numbers.
inline constexpr int kLogBits = 16;
inline constexpr int64_t kLogOne = int64_t{1} << kLogBits;

/// log2(x) in units of 2^-16, rounded down; x >= 1. May be one unit too small.
/// Bit by bit: squaring the mantissa doubles its logarithm.
constexpr uint32_t fixedLog2(uint64_t x) {
  SHOAL_DEMAND(x >= 1);
  const int whole = 63 - std::countl_zero(x);
  uint64_t mantissa = whole > 31 ? x >> (whole - 31) : x << (31 - whole);  // in [1, 2), units of 2^-31
  auto log = static_cast<uint32_t>(whole);
  for (int bit = 0; bit < kLogBits; ++bit) {
    mantissa = (mantissa * mantissa) >> 31;
    const uint64_t above = mantissa >> 32;
    log = log << 1 | static_cast<uint32_t>(above);
    mantissa >>= above;
  }
  return log;
}

namespace detail {

constexpr uint64_t floorSqrt(uint64_t x) {
  uint64_t root = 0;
  for (uint64_t bit = uint64_t{1} << 31; bit > 0; bit >>= 1) {
    if ((root + bit) * (root + bit) <= x) root += bit;
  }
  return root;
}

/// 2^(-2^-1), 2^(-2^-2), ..., 2^(-2^-16) in units of 2^-32: each the square root of the one before.
constexpr std::array<uint64_t, kLogBits> rootsOfHalf() {
  std::array<uint64_t, kLogBits> roots{};
  uint64_t root = uint64_t{1} << 31;
  for (uint64_t& r : roots) {
    root = floorSqrt(root << 32);
    r = root;
  }
  return roots;
}
inline constexpr std::array<uint64_t, kLogBits> kRootsOfHalf = rootsOfHalf();

}  // namespace detail

/// 2^-d in units of 2^-32, d >= 0 in units of 2^-16. Off by at most 17 units; 0 from d = 33 on.
constexpr uint64_t fixedExp2(int64_t d) {
  SHOAL_DEMAND(d >= 0);
  const int64_t whole = d >> kLogBits;
  if (whole > 32) return 0;
  uint64_t power = uint64_t{1} << 32;
  for (int bit = 0; bit < kLogBits; ++bit) {
    if (d >> (kLogBits - 1 - bit) & 1) {
      power = (power * detail::kRootsOfHalf[static_cast<size_t>(bit)]) >> 32;
    }
  }
  return power >> whole;
}

}  // namespace shoal::topics
