// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "shoal/vision/binary_word.h"

namespace shoal::vision {

/// Instructions to search with. They change the speed, never the answer.
enum class SearchPath { kPortable, kPopcnt, kAvx2 };

/// What this processor can do, slowest first. kPortable is always there.
std::vector<SearchPath> availableSearchPaths();

/// Exact nearest words by Hamming distance; of equally near words the lowest index wins.
///
/// Exact, because trees and hashes over binary words lose a fifth of the neighbours or more, and a vector
/// popcount makes 1000 descriptors against 5000 words a matter of milliseconds.
class WordSearch {
 public:
  /// Uses the fastest available path.
  /// @throws std::invalid_argument when there are no words.
  explicit WordSearch(std::vector<BinaryWord> words);

  /// The same on one path, to compare paths.
  /// @throws std::invalid_argument also when this processor lacks the path.
  WordSearch(std::vector<BinaryWord> words, SearchPath path);

  /// Index of the nearest word of each descriptor. Cost: descriptors × words distances.
  std::vector<int32_t> nearest(std::span<const BinaryWord> descriptors) const;

 private:
  // Four words side by side: lanes[part][word], as a 256-bit register takes them.
  struct alignas(32) Block {
    uint64_t lanes[4][4];
  };

  int32_t nearestPortable(const BinaryWord& descriptor) const;
#if defined(__x86_64__)
  int32_t nearestPopcnt(const BinaryWord& descriptor) const;
  void nearestAvx2(std::span<const BinaryWord> descriptors, int32_t* nearest) const;
#endif

  SearchPath path_;
  std::vector<BinaryWord> words_;
  std::vector<Block> blocks_;  // the last one filled up with copies of the last word, which lose every tie
};

}  // namespace shoal::vision
