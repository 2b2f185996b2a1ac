// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/k_majority.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "shoal/random.h"
#include "shoal/vision/word_search.h"

namespace shoal::vision {
namespace {

using BitCounts = std::array<int64_t, kBinaryWordBits>;

std::vector<BinaryWord> drawDistinct(std::span<const BinaryWord> descriptors,
                                     const KMajorityOptions& options) {
  std::vector<BinaryWord> distinct(descriptors.begin(), descriptors.end());
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  const auto num_words = static_cast<size_t>(options.num_words);
  if (distinct.size() < num_words) {
    throw std::invalid_argument("a vocabulary of " + std::to_string(num_words) +
                                " words needs as many distinct descriptors, got " +
                                std::to_string(distinct.size()));
  }
  Random random(options.seed);
  for (size_t i = 0; i < num_words; ++i) {  // the first steps of Fisher and Yates' shuffle
    std::swap(distinct[i], distinct[i + static_cast<size_t>(random.below(distinct.size() - i))]);
  }
  distinct.resize(num_words);
  return distinct;
}

BinaryWord majority(const BitCounts& set_bits, int64_t members, const BinaryWord& previous) {
  BinaryWord word = previous;
  for (size_t bit = 0; bit < kBinaryWordBits; ++bit) {
    const uint64_t mask = uint64_t{1} << (bit % 64);
    if (2 * set_bits[bit] > members) word[bit / 64] |= mask;
    if (2 * set_bits[bit] < members) word[bit / 64] &= ~mask;
  }
  return word;
}

// The new words: the majority of each word's members, and for a word without any the farthest descriptor that
// no other such word took.
std::vector<BinaryWord> update(std::span<const BinaryWord> descriptors, std::span<const int32_t> assigned,
                               const std::vector<BinaryWord>& words) {
  std::vector<BitCounts> set_bits(words.size(), BitCounts{});
  std::vector<int64_t> members(words.size(), 0);
  for (size_t i = 0; i < descriptors.size(); ++i) {
    const auto word = static_cast<size_t>(assigned[i]);
    ++members[word];
    for (size_t bit = 0; bit < kBinaryWordBits; ++bit) {
      set_bits[word][bit] += static_cast<int64_t>((descriptors[i][bit / 64] >> (bit % 64)) & 1);
    }
  }
  std::vector<size_t> farthest_first(descriptors.size());
  std::iota(farthest_first.begin(), farthest_first.end(), size_t{0});
  std::stable_sort(farthest_first.begin(), farthest_first.end(), [&](size_t a, size_t b) {
    return hammingDistance(descriptors[a], words[static_cast<size_t>(assigned[a])]) >
           hammingDistance(descriptors[b], words[static_cast<size_t>(assigned[b])]);
  });
  std::vector<BinaryWord> updated(words.size());
  size_t next = 0;
  for (size_t k = 0; k < words.size(); ++k) {
    updated[k] =
        members[k] > 0 ? majority(set_bits[k], members[k], words[k]) : descriptors[farthest_first[next++]];
  }
  return updated;
}

}  // namespace

KMajorityResult kMajority(std::span<const BinaryWord> descriptors, const KMajorityOptions& options,
                          const std::function<void(int, int64_t, double)>& round_done) {
  if (options.num_words < 1) {
    throw std::invalid_argument("num_words must be > 0, got " + std::to_string(options.num_words));
  }
  if (options.max_rounds < 1) {
    throw std::invalid_argument("max_rounds must be >= 1, got " + std::to_string(options.max_rounds));
  }
  KMajorityResult result{drawDistinct(descriptors, options)};
  std::vector<int32_t> assigned(descriptors.size(), -1);
  for (result.rounds = 1;; ++result.rounds) {
    const std::vector<int32_t> nearest = WordSearch(result.words).nearest(descriptors);
    int64_t changed = 0;
    int64_t distance = 0;
    for (size_t i = 0; i < descriptors.size(); ++i) {
      changed += nearest[i] != assigned[i];
      distance += hammingDistance(descriptors[i], result.words[static_cast<size_t>(nearest[i])]);
    }
    assigned = nearest;
    result.mean_distance = static_cast<double>(distance) / static_cast<double>(descriptors.size());
    if (round_done) round_done(result.rounds, changed, result.mean_distance);
    if (changed == 0) break;
    result.words = update(descriptors, assigned, result.words);
    if (result.rounds == options.max_rounds) break;
  }
  std::sort(result.words.begin(), result.words.end());
  return result;
}

}  // namespace shoal::vision
