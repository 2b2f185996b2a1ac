// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace shoal::wire {

/// Ln of the odds of a probability p / 65536, in units of 1/256, in [-2047, 2047]. Integers only, so that
/// every machine computes the same.
int32_t stretch(uint32_t p);

/// The inverse: 65536 / (1 + exp(-odds / 256)), from a table of 33 points and straight lines between them.
uint32_t squash(int32_t odds);

/// What one context has seen: how likely the next bit is 1.
struct ContextBit {
  uint16_t one = 1u << 15;  ///< P(1) x 65536
  uint8_t seen = 0;         ///< bits seen, at most kMemory
  uint8_t generation = 0;   ///< ContextTable's alone

  static constexpr int kMemory = 250;

  /// Moves 1 / (seen + 1.5) of the way to the bit.
  void update(int bit) {
    const int32_t target = bit != 0 ? 65535 : 0;
    one = static_cast<uint16_t>(one + (target - one) * 2 / (2 * seen + 3));
    if (seen < kMemory) ++seen;
  }
};

/// Makes one probability of those of several contexts by logistic mixing (Mahoney, PAQ6, 2005): a weighted
/// sum of log odds, whose weights follow the gradient of the cost of each bit. A context that has seen
/// little counts less.
class BitMixer {
 public:
  static constexpr size_t kMaxContexts = 8;

  /// @param num_contexts  in [1, kMaxContexts].
  /// @param num_sets      sets of weights, chosen bit by bit.
  BitMixer(size_t num_contexts, size_t num_sets);

  /// Codes a bit with the probability that the contexts mix to, and lets contexts and weights learn.
  template <typename Coder>
  int code(Coder& coder, std::span<ContextBit* const> contexts, size_t set, int bit);

 private:
  size_t num_contexts_;
  std::vector<int32_t> weights_;  // 65536 = 1
};

}  // namespace shoal::wire
