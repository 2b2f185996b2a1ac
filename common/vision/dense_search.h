// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shoal/vision/dense_vocabulary.h"

namespace shoal::vision {

/// Instructions to search with. They change the speed, never the answer.
enum class DenseSearchPath { kPortable, kAvx2 };

/// What this processor can do, slowest first. kPortable is always there.
std::vector<DenseSearchPath> availableDenseSearchPaths();

/// Squared Euclidean distance. The product of dimensions and the largest square must stay below 2^31: true
/// of up to 32 features within kMaxFeature.
int32_t squaredDistance(std::span<const int16_t> a, std::span<const int16_t> b);

/// Exact nearest words by Euclidean distance, in integers; of equally near words the lowest index wins.
class DenseSearch {
 public:
  /// Uses the fastest available path. @param list  as DenseVocabulary holds it: its ranges are not checked.
  explicit DenseSearch(DenseWordList list);

  /// The same on one path, to compare paths.
  /// @throws std::invalid_argument when this processor lacks the path.
  DenseSearch(DenseWordList list, DenseSearchPath path);

  int32_t numWords() const { return list_.numWords(); }

  /// Index of the nearest word of each point.
  /// @param features  points x dimensions, each within kMaxFeature. Cost: points x words distances.
  std::vector<int32_t> nearest(std::span<const int16_t> features) const;

 private:
  int32_t nearestPortable(std::span<const int16_t> point) const;
#if defined(__x86_64__)
  void nearestAvx2(std::span<const int16_t> features, std::span<int32_t> nearest) const;
#endif

  DenseWordList list_;
  DenseSearchPath path_;
  // Eight words side by side, two dimensions at a time, as a 256-bit register takes them: an odd last
  // dimension has a 0 beside it, the last eight are filled up with copies of the last word, which lose every
  // tie.
  struct alignas(32) Lanes {
    int16_t of[8][2];
  };
  std::vector<Lanes> lanes_;  // per eight words, per pair of dimensions
};

}  // namespace shoal::vision
