// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/word_search.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace shoal::vision {

std::vector<SearchPath> availableSearchPaths() {
  std::vector<SearchPath> paths{SearchPath::kPortable};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("popcnt")) paths.push_back(SearchPath::kPopcnt);
  if (__builtin_cpu_supports("avx2")) paths.push_back(SearchPath::kAvx2);
#endif
  return paths;
}

WordSearch::WordSearch(std::vector<BinaryWord> words)
    : WordSearch(std::move(words), availableSearchPaths().back()) {}

WordSearch::WordSearch(std::vector<BinaryWord> words, SearchPath path)
    : path_(path), words_(std::move(words)) {
  if (words_.empty()) throw std::invalid_argument("word search needs at least one word, got none");
  const auto paths = availableSearchPaths();
  if (std::find(paths.begin(), paths.end(), path) == paths.end()) {
    throw std::invalid_argument("this processor lacks the search path asked for");
  }
  blocks_.resize((words_.size() + 3) / 4);
  for (size_t i = 0; i < 4 * blocks_.size(); ++i) {
    const BinaryWord& word = words_[std::min(i, words_.size() - 1)];
    for (size_t part = 0; part < 4; ++part) blocks_[i / 4].lanes[part][i % 4] = word[part];
  }
}

std::vector<int32_t> WordSearch::nearest(std::span<const BinaryWord> descriptors) const {
  std::vector<int32_t> nearest(descriptors.size());
#if defined(__x86_64__)
  if (path_ == SearchPath::kAvx2) {
    nearestAvx2(descriptors, nearest.data());
    return nearest;
  }
  if (path_ == SearchPath::kPopcnt) {
    for (size_t i = 0; i < descriptors.size(); ++i) nearest[i] = nearestPopcnt(descriptors[i]);
    return nearest;
  }
#endif
  for (size_t i = 0; i < descriptors.size(); ++i) nearest[i] = nearestPortable(descriptors[i]);
  return nearest;
}

int32_t WordSearch::nearestPortable(const BinaryWord& descriptor) const {
  int best = kBinaryWordBits + 1;
  size_t best_word = 0;
  for (size_t i = 0; i < words_.size(); ++i) {
    const int distance = hammingDistance(descriptor, words_[i]);
    if (distance < best) {
      best = distance;
      best_word = i;
    }
  }
  return static_cast<int32_t>(best_word);
}

#if defined(__x86_64__)

// The loop of nearestPortable() again: a function does not inline into one with other target instructions.
__attribute__((target("popcnt"))) int32_t WordSearch::nearestPopcnt(const BinaryWord& descriptor) const {
  int best = kBinaryWordBits + 1;
  size_t best_word = 0;
  for (size_t i = 0; i < words_.size(); ++i) {
    const BinaryWord& word = words_[i];
    const int distance =
        __builtin_popcountll(descriptor[0] ^ word[0]) + __builtin_popcountll(descriptor[1] ^ word[1]) +
        __builtin_popcountll(descriptor[2] ^ word[2]) + __builtin_popcountll(descriptor[3] ^ word[3]);
    if (distance < best) {
      best = distance;
      best_word = i;
    }
  }
  return static_cast<int32_t>(best_word);
}

// Four words at a time. Set bits of a byte are looked up by nibble (W. Muła's pshufb popcount); the byte sums
// of the four parts stay below 256, so that one sum of absolute differences adds up each word. Distance and
// index share a 64-bit key, distance first: the least key is the nearest word and, in a tie, the lowest
// index.
__attribute__((target("avx2"))) void WordSearch::nearestAvx2(std::span<const BinaryWord> descriptors,
                                                             int32_t* nearest) const {
  const __m256i bits_of_nibble = _mm256_setr_epi8(0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4,  //
                                                  0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4);
  const __m256i low_nibble = _mm256_set1_epi8(0x0f);
  const __m256i zero = _mm256_setzero_si256();
  const __m256i four = _mm256_set1_epi64x(4);
  for (size_t d = 0; d < descriptors.size(); ++d) {
    __m256i part[4];
    for (size_t p = 0; p < 4; ++p) part[p] = _mm256_set1_epi64x(static_cast<int64_t>(descriptors[d][p]));
    __m256i index = _mm256_setr_epi64x(0, 1, 2, 3);
    __m256i best = _mm256_set1_epi64x(INT64_MAX);
    for (const Block& block : blocks_) {
      __m256i sum = zero;
      for (size_t p = 0; p < 4; ++p) {
        const __m256i words = _mm256_load_si256(reinterpret_cast<const __m256i*>(block.lanes[p]));
        const __m256i unlike = _mm256_xor_si256(words, part[p]);
        const __m256i low = _mm256_and_si256(unlike, low_nibble);
        const __m256i high = _mm256_and_si256(_mm256_srli_epi16(unlike, 4), low_nibble);
        sum = _mm256_add_epi8(sum, _mm256_add_epi8(_mm256_shuffle_epi8(bits_of_nibble, low),
                                                   _mm256_shuffle_epi8(bits_of_nibble, high)));
      }
      const __m256i distance = _mm256_sad_epu8(sum, zero);
      const __m256i key = _mm256_or_si256(_mm256_slli_epi64(distance, 32), index);
      best = _mm256_blendv_epi8(best, key, _mm256_cmpgt_epi64(best, key));
      index = _mm256_add_epi64(index, four);
    }
    alignas(32) int64_t keys[4];
    _mm256_store_si256(reinterpret_cast<__m256i*>(keys), best);
    nearest[d] = static_cast<int32_t>(*std::min_element(keys, keys + 4) & 0x7fffffff);
  }
}

#endif

}  // namespace shoal::vision
