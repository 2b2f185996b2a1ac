// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/label_counts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

#include "shoal/random.h"
#include "shoal/topics/fixed_log.h"

namespace shoal::topics {
namespace {

using world::WordCount;
using world::WordGroup;
using Words = std::vector<WordCount>;

const std::vector<WordGroup> kGroups = {{.name = "color", .first = 0, .size = 7},
                                        {.name = "one", .first = 7, .size = 1},
                                        {.name = "shape", .first = 8, .size = 30}};
constexpr int32_t kVocabulary = 38;

Words randomWords(Random& random, int num_words) {
  std::map<int32_t, int32_t> counts;
  for (int i = 0; i < num_words; ++i) {
    const double u = random.uniform();
    ++counts[static_cast<int32_t>(u * u * kVocabulary)];
  }
  Words words;
  for (const auto& [word, count] : counts) words.push_back({word, count});
  return words;
}

// The definition, in floating point, from plain counts: what `cells` with label k hold, those of `except`
// left out.
double logLikelihood(const Words& words, const std::vector<std::pair<int32_t, Words>>& cells, int32_t label,
                     size_t except, double beta) {
  double sum = 0;
  for (const WordGroup& group : kGroups) {
    std::vector<double> count(static_cast<size_t>(kVocabulary));
    double total = 0;
    for (size_t c = 0; c < cells.size(); ++c) {
      if (cells[c].first != label || c == except) continue;
      for (const WordCount& w : cells[c].second) {
        if (w.word < group.first || w.word >= group.first + group.size) continue;
        count[static_cast<size_t>(w.word)] += w.count;
        total += w.count;
      }
    }
    for (const WordCount& w : words) {
      if (w.word < group.first || w.word >= group.first + group.size) continue;
      sum += w.count * std::log2((count[static_cast<size_t>(w.word)] + beta) / (total + group.size * beta));
    }
  }
  return sum;
}

TEST(LabelCountsTest, ScoresAreTheDefinitionByBruteForce) {
  for (const double beta : {1.0, 0.25, 3.0}) {
    Random random(3);
    LabelCounts counts(kGroups, 5, beta);
    EXPECT_EQ(counts.vocabularySize(), kVocabulary);
    std::vector<std::pair<int32_t, Words>> cells;  // labels 0, 1 and 3; 2 and 4 stay empty
    for (int i = 0; i < 12; ++i) {
      cells.emplace_back(i % 3 == 2 ? 3 : i % 3, randomWords(random, 5 + 300 * (i % 2)));
      counts.add(cells.back().second, cells.back().first);
    }
    std::vector<int64_t> scores(static_cast<size_t>(counts.stride()));
    for (size_t c = 0; c < cells.size(); ++c) {
      const auto& [label, words] = cells[c];
      double num_words = 0;
      for (const WordCount& w : words) num_words += w.count;
      counts.logLikelihoods(words, label, scores);
      for (int32_t k = 0; k < 5; ++k) {
        const double expected = logLikelihood(words, cells, k, c, beta) * kLogOne;
        // Two logarithms a word, each off by less than two units.
        EXPECT_NEAR(static_cast<double>(scores[static_cast<size_t>(k)]), expected, 4 * num_words)
            << "cell " << c << " label " << k;
      }
    }
    // Words that no label holds.
    const Words fresh = randomWords(random, 20);
    counts.logLikelihoods(fresh, -1, scores);
    for (int32_t k = 0; k < 5; ++k) {
      EXPECT_NEAR(static_cast<double>(scores[static_cast<size_t>(k)]),
                  logLikelihood(fresh, cells, k, cells.size(), beta) * kLogOne, 80);
    }
  }
}

// Counts above the table of logarithms, too.
TEST(LabelCountsTest, LargeCountsAreAsExact) {
  LabelCounts counts(kGroups, 2, 1.0);
  counts.add(Words{{0, 100'000}, {3, 5}, {20, 9}}, 1);
  std::vector<int64_t> scores(static_cast<size_t>(counts.stride()));
  counts.logLikelihoods(Words{{0, 1}}, -1, scores);
  EXPECT_NEAR(static_cast<double>(scores[0]), -std::log2(7.0) * kLogOne, 4);
  EXPECT_NEAR(static_cast<double>(scores[1]), std::log2(100'001.0 / 100'012.0) * kLogOne, 4);
}

TEST(LabelCountsTest, TakingOutUndoesPuttingIn) {
  Random random(4);
  LabelCounts counts(kGroups, 3, 1.0);
  const Words first = randomWords(random, 50), second = randomWords(random, 80),
              asked = randomWords(random, 30);
  counts.add(first, 2);
  std::vector<int64_t> before(static_cast<size_t>(counts.stride())), after = before;
  counts.logLikelihoods(asked, -1, before);
  counts.add(second, 2);
  counts.logLikelihoods(asked, -1, after);
  EXPECT_NE(after, before);
  counts.remove(second, 2);
  counts.logLikelihoods(asked, -1, after);
  EXPECT_EQ(after, before);
  for (const WordCount& w : first) EXPECT_EQ(counts.wordCounts(w.word)[2], w.count);
}

TEST(LabelCountsTest, RefusesGroupsThatDoNotTileTheVocabulary) {
  EXPECT_THROW(LabelCounts({}, 3, 1.0), std::invalid_argument);
  EXPECT_THROW(LabelCounts({{.name = "a", .first = 1, .size = 2}}, 3, 1.0), std::invalid_argument);
  EXPECT_THROW(LabelCounts({{.name = "a", .first = 0, .size = 0}}, 3, 1.0), std::invalid_argument);
  EXPECT_THROW(
      LabelCounts({{.name = "a", .first = 0, .size = 2}, {.name = "b", .first = 3, .size = 2}}, 3, 1.0),
      std::invalid_argument);
  EXPECT_THROW(LabelCounts({{.name = "a", .first = 0, .size = 2'000'000'000}}, 3, 1.0),
               std::invalid_argument);
}

}  // namespace
}  // namespace shoal::topics
