// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/dense_search.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "shoal/demand.h"

namespace shoal::vision {

std::vector<DenseSearchPath> availableDenseSearchPaths() {
  std::vector<DenseSearchPath> paths{DenseSearchPath::kPortable};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) paths.push_back(DenseSearchPath::kAvx2);
#endif
  return paths;
}

int32_t squaredDistance(std::span<const int16_t> a, std::span<const int16_t> b) {
  int32_t sum = 0;
  for (size_t d = 0; d < a.size(); ++d) {
    const int32_t difference = a[d] - b[d];
    sum += difference * difference;
  }
  return sum;
}

DenseSearch::DenseSearch(DenseWordList list)
    : DenseSearch(std::move(list), availableDenseSearchPaths().back()) {}

DenseSearch::DenseSearch(DenseWordList list, DenseSearchPath path) : list_(std::move(list)), path_(path) {
  SHOAL_DEMAND(list_.dimensions > 0 && list_.numWords() > 0);
  const auto paths = availableDenseSearchPaths();
  if (std::find(paths.begin(), paths.end(), path) == paths.end()) {
    throw std::invalid_argument("this processor lacks the search path asked for");
  }
  const auto dimensions = static_cast<size_t>(list_.dimensions),
             words = static_cast<size_t>(list_.numWords());
  for (size_t first = 0; first < words; first += 8) {
    for (size_t d = 0; d < dimensions; d += 2) {
      Lanes& lanes = lanes_.emplace_back(Lanes{});
      for (size_t n = 0; n < 8; ++n) {
        const size_t word = std::min(first + n, words - 1);
        lanes.of[n][0] = list_.words[word * dimensions + d];
        if (d + 1 < dimensions) lanes.of[n][1] = list_.words[word * dimensions + d + 1];
      }
    }
  }
}

std::vector<int32_t> DenseSearch::nearest(std::span<const int16_t> features) const {
  const auto dimensions = static_cast<size_t>(list_.dimensions);
  SHOAL_DEMAND(features.size() % dimensions == 0);
  std::vector<int32_t> nearest(features.size() / dimensions);
#if defined(__x86_64__)
  if (path_ == DenseSearchPath::kAvx2) {
    nearestAvx2(features, nearest);
    return nearest;
  }
#endif
  for (size_t i = 0; i < nearest.size(); ++i) {
    nearest[i] = nearestPortable(features.subspan(i * dimensions, dimensions));
  }
  return nearest;
}

int32_t DenseSearch::nearestPortable(std::span<const int16_t> point) const {
  int32_t least = std::numeric_limits<int32_t>::max();
  int32_t nearest = 0;
  for (int32_t word = 0; word < list_.numWords(); ++word) {
    const auto first = static_cast<size_t>(word) * point.size();
    const int32_t distance = squaredDistance(point, std::span(list_.words).subspan(first, point.size()));
    if (distance < least) {
      least = distance;
      nearest = word;
    }
  }
  return nearest;
}

#if defined(__x86_64__)

// Eight words at a time: differences of 16 bits, squares added in pairs into 32 bits. A lane keeps its first
// least distance; in the end the least of the lanes wins, of equal ones that with the lowest word.
__attribute__((target("avx2"))) void DenseSearch::nearestAvx2(std::span<const int16_t> features,
                                                              std::span<int32_t> nearest) const {
  const auto dimensions = static_cast<size_t>(list_.dimensions);
  const size_t pairs = (dimensions + 1) / 2;
  for (size_t i = 0; i < nearest.size(); ++i) {
    __m256i point[16];
    for (size_t p = 0; p < pairs; ++p) {
      const auto value = [&](size_t d) {
        return d < dimensions ? static_cast<uint16_t>(features[i * dimensions + d]) : uint16_t{0};
      };
      point[p] = _mm256_set1_epi32(static_cast<int32_t>(value(2 * p) | uint32_t{value(2 * p + 1)} << 16));
    }
    __m256i word = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
    __m256i least = _mm256_set1_epi32(std::numeric_limits<int32_t>::max());
    __m256i least_word = word;
    for (size_t block = 0; block < lanes_.size(); block += pairs) {
      __m256i distance = _mm256_setzero_si256();
      for (size_t p = 0; p < pairs; ++p) {
        const __m256i lanes = _mm256_load_si256(reinterpret_cast<const __m256i*>(&lanes_[block + p]));
        const __m256i difference = _mm256_sub_epi16(lanes, point[p]);
        distance = _mm256_add_epi32(distance, _mm256_madd_epi16(difference, difference));
      }
      const __m256i nearer = _mm256_cmpgt_epi32(least, distance);
      least = _mm256_blendv_epi8(least, distance, nearer);
      least_word = _mm256_blendv_epi8(least_word, word, nearer);
      word = _mm256_add_epi32(word, _mm256_set1_epi32(8));
    }
    alignas(32) int32_t distances[8], words[8];
    _mm256_store_si256(reinterpret_cast<__m256i*>(distances), least);
    _mm256_store_si256(reinterpret_cast<__m256i*>(words), least_word);
    size_t best = 0;
    for (size_t n = 1; n < 8; ++n) {
      if (std::pair(distances[n], words[n]) < std::pair(distances[best], words[best])) best = n;
    }
    nearest[i] = words[best];
  }
}

#endif

}  // namespace shoal::vision
