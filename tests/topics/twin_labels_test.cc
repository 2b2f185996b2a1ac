// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/twin_labels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "shoal/random.h"

namespace shoal::topics {
namespace {

using Counts = std::vector<std::vector<int32_t>>;  // by label, of every word
using Labels = std::vector<int32_t>;

const std::vector<world::WordGroup> kGroups = {{.name = "color", .first = 0, .size = 4},
                                               {.name = "shape", .first = 4, .size = 6}};

LabelCounts table(const Counts& counts) {
  LabelCounts table(kGroups, static_cast<int32_t>(counts.size()), 0.1);
  for (size_t k = 0; k < counts.size(); ++k) {
    std::vector<world::WordCount> words;
    for (size_t w = 0; w < counts[k].size(); ++w) {
      if (counts[k][w] > 0) words.push_back({static_cast<int32_t>(w), counts[k][w]});
    }
    table.add(words, static_cast<int32_t>(k));
  }
  return table;
}

// The definition, in floating point.
double similarity(const Counts& counts, size_t a, size_t b) {
  double dot = 0, aa = 0, bb = 0;
  for (const world::WordGroup& group : kGroups) {
    const auto first = static_cast<size_t>(group.first), end = first + static_cast<size_t>(group.size);
    std::vector<double> total(counts.size());
    double votes = 0.25;
    for (size_t k = 0; k < counts.size(); ++k) {
      for (size_t w = first; w < end; ++w) total[k] += counts[k][w];
      votes += total[k] > 0;
    }
    for (size_t w = first; w < end; ++w) {
      double mean = 0.25 / group.size;
      for (size_t k = 0; k < counts.size(); ++k) mean += total[k] > 0 ? counts[k][w] / total[k] : 0;
      mean /= votes;
      const auto contrast = [&](size_t k) {
        return std::sqrt((counts[k][w] + 100 * mean) / (total[k] + 100)) - std::sqrt(mean);
      };
      dot += contrast(a) * contrast(b);
      aa += contrast(a) * contrast(a);
      bb += contrast(b) * contrast(b);
    }
  }
  return dot / std::sqrt(aa * bb);
}

Counts randomCounts(Random& random, size_t num_labels) {
  Counts counts(num_labels, std::vector<int32_t>(10));
  for (auto& label : counts) {
    const uint64_t most = 1 + random.below(2000);
    for (int32_t& count : label) count = static_cast<int32_t>(random.below(most));
  }
  return counts;
}

TEST(TwinLabelsTest, JoinsTwoExactlyWhenTheyAreAsAlikeAsAsked) {
  Random random(11);
  for (int trial = 0; trial < 50; ++trial) {
    const Counts counts = randomCounts(random, 3);
    // The most alike pair of three is joined first.
    double most = -1;
    for (const auto& [a, b] : {std::pair{0, 1}, {0, 2}, {1, 2}}) {
      most = std::max(most, similarity(counts, static_cast<size_t>(a), static_cast<size_t>(b)));
    }
    if (most < 0.01) continue;
    EXPECT_EQ(twinLabels(table(counts), Labels{0, 1, 2}, std::min(most + 1e-4, 1.0)), (Labels{0, 1, 2}));
    EXPECT_NE(twinLabels(table(counts), Labels{0, 1, 2}, most - 1e-4), (Labels{0, 1, 2}));
  }
}

// Average linkage from the definition: sets of greatest mean similarity, again and again.
TEST(TwinLabelsTest, EqualsAverageLinkageByBruteForce) {
  Random random(5);
  int joined = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const size_t n = 2 + random.below(7);
    const Counts counts = randomCounts(random, n);
    const double least = 0.05 + 0.3 * random.uniform();
    std::vector<std::vector<size_t>> sets;
    for (size_t k = 0; k < n; ++k) sets.push_back({k});
    while (true) {
      double best = least;
      std::pair<size_t, size_t> pair{0, 0};
      for (size_t i = 0; i < sets.size(); ++i) {
        for (size_t j = i + 1; j < sets.size(); ++j) {
          double mean = 0;
          for (const size_t a : sets[i]) {
            for (const size_t b : sets[j]) mean += similarity(counts, a, b);
          }
          mean /= static_cast<double>(sets[i].size() * sets[j].size());
          if (mean > best) {
            best = mean;
            pair = {i, j};
          }
        }
      }
      if (pair.second == 0) break;
      sets[pair.first].insert(sets[pair.first].end(), sets[pair.second].begin(), sets[pair.second].end());
      sets.erase(sets.begin() + static_cast<ptrdiff_t>(pair.second));
      ++joined;
    }
    Labels all, expected(n);
    for (size_t k = 0; k < n; ++k) all.push_back(static_cast<int32_t>(k));
    for (const auto& set : sets) {
      for (const size_t k : set) expected[k] = static_cast<int32_t>(*std::ranges::min_element(set));
    }
    EXPECT_EQ(twinLabels(table(counts), all, least), expected) << trial;
  }
  EXPECT_GT(joined, 20);
}

// Two of a kind and one that is not, in slots with gaps between them.
TEST(TwinLabelsTest, LooksAtTheLabelsInUseAlone) {
  Counts counts(6, std::vector<int32_t>(10));
  counts[1] = {900, 50, 50, 0, 500, 500, 0, 0, 0, 0};
  counts[3] = {0, 0, 100, 900, 0, 0, 0, 10, 500, 490};
  counts[5] = {880, 70, 40, 10, 480, 510, 10, 0, 0, 0};
  EXPECT_EQ(twinLabels(table(counts), Labels{1, 3, 5}, 0.5), (Labels{1, 3, 1}));
  EXPECT_EQ(twinLabels(table(counts), Labels{3, 5}, 0.5), (Labels{3, 5}));
  EXPECT_EQ(twinLabels(table(counts), Labels{1, 3, 5}, 1.0), (Labels{1, 3, 5}));
  EXPECT_EQ(twinLabels(table(counts), Labels{}, 0.5), Labels{});
  EXPECT_EQ(twinLabels(table(counts), Labels{3}, 0.5), Labels{3});
}

}  // namespace
}  // namespace shoal::topics
