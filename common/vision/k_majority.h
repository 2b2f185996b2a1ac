// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "shoal/vision/binary_word.h"

namespace shoal::vision {

struct KMajorityOptions {
  int32_t num_words = 5000;  ///< > 0
  int max_rounds = 30;       ///< >= 1; stops earlier when no descriptor changes its word
  uint64_t seed = 1;
};

struct KMajorityResult {
  std::vector<BinaryWord> words;  ///< ascending
  int rounds = 0;
  double mean_distance = 0.0;  ///< of a descriptor to its word before the last update, bits
};

/// Clusters binary descriptors: k-means with Hamming distance, where the bit of a word is the majority of its
/// members (a tie keeps the bit). A word without members moves to the descriptor farthest from its own word.
/// Starts from distinct descriptors drawn at random. The order of `descriptors` and how often one is repeated
/// matter; with equal input and options the words are equal, on every machine.
///
/// Source: C. Grana et al., "A Fast Approach for Integrating ORB Descriptors in the Bag of Words Model",
/// 2013.
///
/// @param round_done  told round (from 1), descriptors that changed their word, and mean distance.
/// @throws std::invalid_argument when there are fewer distinct descriptors than words, or an option is out of
///         range.
/// Cost: rounds × descriptors × words distances.
KMajorityResult kMajority(std::span<const BinaryWord> descriptors, const KMajorityOptions& options,
                          const std::function<void(int, int64_t, double)>& round_done = {});

}  // namespace shoal::vision
