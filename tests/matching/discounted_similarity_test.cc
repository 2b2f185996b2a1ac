// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/discounted_similarity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "shoal/random.h"

namespace shoal::matching {
namespace {

Descriptor descriptorOf(const std::vector<int64_t>& weights) {
  Descriptor d;
  for (size_t w = 0; w < weights.size(); ++w)
    if (weights[w] > 0) d.entries.push_back({static_cast<int32_t>(w), weights[w]});
  return d;
}

// The definition in doubles, words of the groups [0, split) and [split, end).
double expected(const std::vector<std::vector<int64_t>>& topics, size_t split, size_t i, size_t j) {
  const size_t words = topics[0].size();
  const auto groupOf = [&](size_t w) { return w < split ? 0 : 1; };
  const double size[2] = {static_cast<double>(split), static_cast<double>(words - split)};
  std::vector<std::vector<double>> total(topics.size(), std::vector<double>(2));
  for (size_t t = 0; t < topics.size(); ++t)
    for (size_t w = 0; w < words; ++w) total[t][groupOf(w)] += static_cast<double>(topics[t][w]);
  const auto contrast = [&](size_t t, size_t w) {
    const int g = groupOf(w);
    double background = .25 / size[g], votes = .25;
    for (size_t u = 0; u < topics.size(); ++u) {
      if (total[u][g] == 0) continue;
      background += static_cast<double>(topics[u][w]) / total[u][g];
      ++votes;
    }
    background /= votes;
    const double phi = (static_cast<double>(topics[t][w]) + 100 * background) / (total[t][g] + 100);
    return std::sqrt(phi) - std::sqrt(background);
  };
  double ab = 0, aa = 0, bb = 0;
  for (size_t w = 0; w < words; ++w) {
    const double a = contrast(i, w), b = contrast(j, w);
    ab += a * b, aa += a * a, bb += b * b;
  }
  return aa * bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

TEST(DiscountedSimilarityTest, IsWhatItsDefinitionSays) {
  for (uint64_t seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    std::vector<std::vector<int64_t>> topics(5, std::vector<int64_t>(9));
    DescriptorSet set{9, {0, 4}, {{}, {}}};
    for (size_t t = 0; t < topics.size(); ++t) {
      for (size_t w = t == 3 ? 4 : 0; w < 9; ++w) topics[t][w] = static_cast<int64_t>(random.below(400));
      set.robots[t / 3].push_back(descriptorOf(topics[t]));
    }
    const PairTable table = discountedSimilarity(set);
    for (size_t i = 0; i < topics.size(); ++i)
      for (size_t j = 0; j < i; ++j)
        EXPECT_NEAR(table.at(static_cast<int>(i), static_cast<int>(j)) / 1e9, expected(topics, 4, i, j),
                    2e-5);
  }
}

// The same in whole numbers, as plainly as can be: what every build and machine must find, to the last unit.
PairTable inWholeNumbers(const std::vector<std::vector<int64_t>>& topics, size_t split) {
  __extension__ using Wide = __int128;
  constexpr int64_t kOne = int64_t{1} << 52;
  const size_t words = topics[0].size();
  const auto rootOf = [](Wide p) { return std::llround(std::sqrt(static_cast<double>(p))) >> 6; };
  std::vector<std::vector<int64_t>> row(topics.size(), std::vector<int64_t>(words));
  for (const auto& [first, end] : {std::pair(size_t{0}, split), std::pair(split, words)}) {
    std::vector<int64_t> total(topics.size());
    for (size_t t = 0; t < topics.size(); ++t)
      for (size_t w = first; w < end; ++w) total[t] += topics[t][w];
    for (size_t w = first; w < end; ++w) {
      Wide sum = kOne / static_cast<int64_t>(end - first), votes = 1;
      for (size_t t = 0; t < topics.size(); ++t) {
        if (total[t] == 0) continue;
        sum += 4 * (Wide{topics[t][w]} * kOne / total[t]);
        votes += 4;
      }
      const Wide mean = sum / votes;
      for (size_t t = 0; t < topics.size(); ++t)
        row[t][w] = rootOf((Wide{topics[t][w]} * kOne + 100 * mean) / (Wide{total[t]} + 100)) - rootOf(mean);
    }
  }
  PairTable table(static_cast<int>(topics.size()));
  const auto dot = [&](size_t i, size_t j) {
    int64_t sum = 0;
    for (size_t w = 0; w < words; ++w) sum += row[i][w] * row[j][w];
    return static_cast<double>(sum);
  };
  for (size_t i = 0; i < topics.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      const double lengths = std::sqrt(dot(i, i)) * std::sqrt(dot(j, j));
      const double cosine = lengths > 0 ? dot(i, j) / lengths : 0;
      table.at(static_cast<int>(i), static_cast<int>(j)) =
          static_cast<int32_t>(std::lround(std::clamp(cosine, -1.0, 1.0) * 1e9));
    }
  }
  return table;
}

TEST(DiscountedSimilarityTest, IsTheSameToTheLastUnitHoweverItIsWorkedOut) {
  for (uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed, 1);
    const size_t words = 2 + random.below(40), split = 1 + random.below(words - 1);
    std::vector<std::vector<int64_t>> topics(1 + random.below(14), std::vector<int64_t>(words));
    DescriptorSet set{static_cast<int32_t>(words), {0, static_cast<int32_t>(split)}, {{}}};
    for (std::vector<int64_t>& topic : topics) {
      // Up to 2^44 of a word: more than 64 bits hold of its share; topics without words in a group or at all.
      const uint64_t most = uint64_t{1} << (4 * random.below(12));
      for (size_t w = random.below(3) == 0 ? split : 0; w < words && most > 1; ++w)
        if (random.below(3) > 0) topic[w] = static_cast<int64_t>(random.below(most));
      set.robots[0].push_back(descriptorOf(topic));
    }
    const PairTable table = discountedSimilarity(set), plain = inWholeNumbers(topics, split);
    for (int i = 0; i < table.size(); ++i)
      for (int j = 0; j < i; ++j) ASSERT_EQ(table.at(i, j), plain.at(i, j)) << i << ", " << j;
  }
}

TEST(DiscountedSimilarityTest, TakesTheBackgroundFromWhatTopicsShare) {
  // Three topics that are mostly sand, with a tenth of something of their own; the last two share it.
  const DescriptorSet set{
      4,
      {},
      {{descriptorOf({900, 100, 0, 0})}, {descriptorOf({900, 0, 100, 0})}, {descriptorOf({900, 0, 100, 1})}}};
  const PairTable table = discountedSimilarity(set);
  EXPECT_LT(table.at(0, 1), 0);
  EXPECT_LT(table.at(0, 2), 0);
  EXPECT_GT(table.at(1, 2), 900'000'000);
}

TEST(DiscountedSimilarityTest, TellsTwoTopicsAloneWhetherTheyAreAlike) {
  const PairTable alike =
      discountedSimilarity({3, {}, {{descriptorOf({900, 100, 0})}, {descriptorOf({880, 120, 0})}}});
  EXPECT_GT(alike.at(0, 1), 900'000'000);
  const PairTable other =
      discountedSimilarity({3, {}, {{descriptorOf({900, 100, 0})}, {descriptorOf({0, 100, 900})}}});
  EXPECT_LT(other.at(0, 1), 100'000'000);
}

TEST(DiscountedSimilarityTest, CallsATopicWithoutWordsUnlikeAll) {
  const PairTable table =
      discountedSimilarity({2, {}, {{descriptorOf({5, 1}), descriptorOf({})}, {descriptorOf({})}}});
  EXPECT_EQ(table.at(0, 1), 0);
  EXPECT_EQ(table.at(1, 2), 0);
}

TEST(DiscountedSimilarityTest, TrustsFewWordsLess) {
  // Topic 2 and topic 3 hold the same shares, but topic 3 says so with four words only: its group is mostly
  // background.
  const DescriptorSet set{4,
                          {0, 2},
                          {{descriptorOf({500, 0, 500, 0})},
                           {descriptorOf({0, 500, 0, 500})},
                           {descriptorOf({0, 500, 500, 0})},
                           {descriptorOf({0, 4, 500, 0})}}};
  const PairTable table = discountedSimilarity(set);
  EXPECT_GT(table.at(0, 3), table.at(0, 2));
}

}  // namespace
}  // namespace shoal::matching
