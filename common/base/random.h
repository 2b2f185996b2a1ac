// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>

#include "shoal/demand.h"

namespace shoal {

/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014): a bijection of 64-bit words that scatters
/// neighbouring inputs.
constexpr uint64_t mix64(uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// Folds `value` into a running 64-bit hash. Order matters. Not cryptographic.
constexpr uint64_t hashCombine(uint64_t hash, uint64_t value) { return mix64(hash ^ mix64(value)); }

/// A counter-based generator: the n-th number is a pure function of the key and n, so that no result
/// depends on which thread, or in which order, numbers are drawn.
///
///     Random random(mission_seed, robot, cell, visit);
///
/// Satisfies std::uniform_random_bit_generator, but prefer its own members: the distributions of <random>
/// differ between standard libraries.
class Random {
 public:
  using result_type = uint64_t;

  explicit constexpr Random(uint64_t seed, uint64_t a = 0, uint64_t b = 0, uint64_t c = 0)
      : key_(hashCombine(hashCombine(hashCombine(mix64(seed), a), b), c)) {}

  static constexpr uint64_t min() { return 0; }
  static constexpr uint64_t max() { return std::numeric_limits<uint64_t>::max(); }

  /// The next 64 uniform bits.
  constexpr uint64_t operator()() { return mix64(key_ + counter_++ * 0x9e3779b97f4a7c15u); }

  /// Uniform in [0, 1), 53 bits.
  constexpr double uniform() { return static_cast<double>((*this)() >> 11) * 0x1.0p-53; }

  /// Uniform in [0, n), n > 0. Bias below n / 2^64.
  constexpr uint64_t below(uint64_t n) {
    SHOAL_DEMAND(n > 0);
    return static_cast<uint64_t>((static_cast<Wide>((*this)()) * n) >> 64);
  }

 private:
  __extension__ using Wide = unsigned __int128;
  uint64_t key_;
  uint64_t counter_ = 0;
};

}  // namespace shoal
