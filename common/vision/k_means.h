// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace shoal::vision {

struct KMeansOptions {
  int32_t num_words = 200;  ///< > 0
  int max_rounds = 20;      ///< >= 1; stops earlier when no point changes its word
  uint64_t seed = 1;
};

struct KMeansResult {
  std::vector<int16_t> words;  ///< words x dimensions, ascending in dictionary order
  int rounds = 0;
  double mean_squared_distance = 0.0;  ///< of a point to its word before the last update
};

/// Lloyd's k-means in integers: a word is the mean of its members, rounded. Starts as k-means++ (D. Arthur
/// and S. Vassilvitskii 2007): a word is drawn among the points with odds in proportion to the squared
/// distance to those drawn before. A word without members moves to the point farthest from its own word. With
/// equal points and options the words are equal, on every machine.
///
/// @param points      points x dimensions, each within kMaxFeature (dense_features.h).
/// @param dimensions  in [1, 32].
/// @param round_done  told round (from 1), points that changed their word, and mean squared distance.
/// @throws std::invalid_argument when there are fewer distinct points than words, or an option is out of
/// range. Cost: rounds x points x words distances.
KMeansResult kMeans(std::span<const int16_t> points, int dimensions, const KMeansOptions& options,
                    const std::function<void(int, int64_t, double)>& round_done = {});

}  // namespace shoal::vision
