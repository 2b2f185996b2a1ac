// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/likeliest_labels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "shoal/random.h"
#include "shoal/topics/fixed_log.h"

namespace shoal::topics {
namespace {

constexpr int64_t kWords = 100;
const ConditionalScale kScale = ConditionalScale::of(10, 1);  // a tenth of the words' weight; J = 1

// Cells in a row, each with log2 likelihoods of its labels.
struct Row {
  explicit Row(const std::vector<std::vector<double>>& bits) {
    for (size_t c = 0; c < bits.size(); ++c) neighborhood.insert({static_cast<int32_t>(c), 0, 0});
    for (const std::vector<double>& of_cell : bits) {
      std::vector<int64_t> row;
      for (const double b : of_cell) row.push_back(static_cast<int64_t>(b * kLogOne));
      candidates.add(row, kWords, std::vector<int64_t>(row.size()));
    }
  }
  std::vector<int32_t> likeliest(int rounds) const {
    return likeliestLabels(candidates, rounds, [] {});
  }

  Neighborhood neighborhood;
  LabelCandidates candidates{neighborhood, kScale};
};

using Labels = std::vector<int32_t>;

// A neighbour is worth log2(e) = 1.44 bits, words a tenth of theirs.
TEST(LikeliestLabelsTest, NeighboursOutvoteWordsThatAreInDoubt) {
  const Row doubt({{0, -90}, {-20, 0}, {0, -90}});  // 2.89 bits for what the words say 2 against
  EXPECT_EQ(doubt.likeliest(0), (Labels{0, 1, 0}));
  EXPECT_EQ(doubt.likeliest(1), (Labels{0, 0, 0}));
  const Row sure({{0, -90}, {-30, 0}, {0, -90}});  // 3 bits
  EXPECT_EQ(sure.likeliest(6), (Labels{0, 1, 0}));
}

TEST(LikeliestLabelsTest, ARoundGoesOnWithWhatItHasJustFound) {
  // The first cell is sure, each of the others prefers a label of its own by one bit; a vote is worth more.
  const Row chain({{0, -90, -90}, {-10, 0, -90}, {-10, -90, 0}});
  EXPECT_EQ(chain.likeliest(0), (Labels{0, 1, 2}));
  EXPECT_EQ(chain.likeliest(1), (Labels{0, 0, 0}));
}

TEST(LikeliestLabelsTest, WhatElseSpeaksForALabelCountsAsBits) {
  Neighborhood neighborhood;
  neighborhood.insert({0, 0, 0});
  for (const int64_t bits : {2, 4}) {  // against 3 bits of the words
    LabelCandidates candidates(neighborhood, kScale);
    candidates.add(std::vector<int64_t>{0, -30 * kLogOne}, kWords, std::vector<int64_t>{0, bits * kLogOne});
    EXPECT_EQ(likeliestLabels(candidates, 1, [] {}), Labels{bits > 3 ? 1 : 0});
  }
}

TEST(LikeliestLabelsTest, TiesGoToTheLowest) { EXPECT_EQ(Row({{0, 0, 0}}).likeliest(3), Labels{0}); }

// Besag 1986: no round makes the labels less likely, and when nothing changes any more each cell has the
// likeliest label that it can have beside its neighbours. By the definition, in floating point.
TEST(LikeliestLabelsTest, EveryRoundIsAtLeastAsLikelyAndTheLastIsAMode) {
  Random random(4);
  for (int trial = 0; trial < 60; ++trial) {
    constexpr int32_t kSide = 6, kLabels = 4;
    Neighborhood neighborhood;
    for (int32_t c = 0; c < kSide * kSide; ++c) neighborhood.insert({c / kSide, c % kSide, 0});
    LabelCandidates candidates(neighborhood, kScale);
    std::vector<std::vector<int64_t>> log_likelihoods(kSide * kSide);
    for (auto& row : log_likelihoods) {
      for (int32_t k = 0; k < kLabels; ++k) row.push_back(-static_cast<int64_t>(random.below(50 * kLogOne)));
      candidates.add(row, kWords, std::vector<int64_t>(row.size()));
    }
    const auto words = [&](int32_t c, int32_t k) {
      return static_cast<double>(log_likelihoods[static_cast<size_t>(c)][static_cast<size_t>(k)]) / kLogOne *
             0.1;
    };
    const auto alike = [&](const Labels& labels, int32_t c, int32_t k) {
      int32_t votes = 0;
      for (const int32_t n : neighborhood.of(c)) votes += labels[static_cast<size_t>(n)] == k;
      return votes * 1.4426950408889634;
    };
    double last = -1e9;
    Labels labels;
    for (const int rounds : {0, 1, 2, 3, 100}) {
      labels = likeliestLabels(candidates, rounds, [] {});
      double bits = 0;
      for (int32_t c = 0; c < kSide * kSide; ++c) {
        const int32_t k = labels[static_cast<size_t>(c)];
        bits += words(c, k) + alike(labels, c, k) / 2;  // a pair counts once
      }
      if (rounds > 0) {
        EXPECT_GE(bits, last - 1e-3);
      }
      last = bits;
    }
    for (int32_t c = 0; c < kSide * kSide; ++c) {
      const int32_t told = labels[static_cast<size_t>(c)];
      for (int32_t k = 0; k < kLabels; ++k)
        EXPECT_LE(words(c, k) + alike(labels, c, k), words(c, told) + alike(labels, c, told) + 1e-3);
    }
  }
}

// All labels of all cells, by the conditional and what else speaks for them.
Labels byTheDefinition(const std::vector<std::vector<int64_t>>& log_likelihoods,
                       const std::vector<std::vector<int64_t>>& in_favour,
                       const std::vector<int64_t>& num_words, const Neighborhood& neighborhood, int rounds) {
  Labels labels;
  for (int round = 0; round <= rounds; ++round) {
    for (size_t c = 0; c < log_likelihoods.size(); ++c) {
      std::vector<int32_t> votes(log_likelihoods[c].size());
      if (round > 0)
        for (const int32_t n : neighborhood.of(static_cast<int32_t>(c)))
          ++votes[static_cast<size_t>(labels[static_cast<size_t>(n)])];
      int32_t now = 0;
      int64_t most = std::numeric_limits<int64_t>::min();
      for (size_t k = 0; k < votes.size(); ++k) {
        const int64_t weight = weightOfWords(log_likelihoods[c][k], num_words[c], kScale) +
                               kScale.coupling * votes[k] + in_favour[c][k];
        if (weight > most) now = static_cast<int32_t>(k);
        most = std::max(most, weight);
      }
      if (round == 0) {
        labels.push_back(now);
      } else {
        labels[c] = now;
      }
    }
  }
  return labels;
}

// Labels that no votes could help are not kept; the two that words fit best are: their distance is the
// certainty.
TEST(LikeliestLabelsTest, WhatIsNotKeptWouldHaveChangedNothing) {
  Random random(5);
  size_t num_kept = 0, num_labels = 0;
  for (int trial = 0; trial < 40; ++trial) {
    constexpr int32_t kSide = 7;
    const size_t labels = 1 + random.below(9);
    Neighborhood neighborhood;
    for (int32_t c = 0; c < kSide * kSide; ++c) neighborhood.insert({c / kSide, c % kSide, 0});
    LabelCandidates candidates(neighborhood, kScale);
    std::vector<std::vector<int64_t>> log_likelihoods(kSide * kSide), in_favour;
    std::vector<int64_t> num_words;
    for (auto& row : log_likelihoods) {
      std::vector<int64_t>& favour = in_favour.emplace_back();
      for (size_t k = 0; k < labels; ++k)
        favour.push_back(trial % 2 == 0 ? 0 : static_cast<int64_t>(random.below(9)) * kLogOne);
      num_words.push_back(static_cast<int64_t>(1 + random.below(200)));
      // In steps, so that some are equal.
      for (size_t k = 0; k < labels; ++k)
        row.push_back(-static_cast<int64_t>(random.below(40)) * kLogOne * num_words.back() / 30);
      candidates.add(row, num_words.back(), favour);
      const auto kept = candidates.of(candidates.numCells() - 1);
      num_kept += kept.size();
      num_labels += labels;
      auto sorted = row;
      std::ranges::sort(sorted, std::greater<>());
      std::vector<int64_t> kept_of_it;
      for (const auto& each : kept) {
        EXPECT_EQ(each.log_likelihood, row[static_cast<size_t>(each.label)]);
        kept_of_it.push_back(each.log_likelihood);
      }
      std::ranges::sort(kept_of_it, std::greater<>());
      ASSERT_GE(kept_of_it.size(), std::min<size_t>(2, labels));
      for (size_t i = 0; i < std::min<size_t>(2, labels); ++i) EXPECT_EQ(kept_of_it[i], sorted[i]);
    }
    for (const int rounds : {0, 1, 5})
      EXPECT_EQ(likeliestLabels(candidates, rounds, [] {}),
                byTheDefinition(log_likelihoods, in_favour, num_words, neighborhood, rounds));
  }
  EXPECT_LT(num_kept, num_labels * 2 / 3);
}

TEST(LikeliestLabelsTest, BreathesNowAndThen) {
  constexpr int32_t kCells = 30'000;
  Neighborhood neighborhood;
  for (int32_t c = 0; c < kCells; ++c) neighborhood.insert({c, 0, 0});
  LabelCandidates candidates(neighborhood, kScale);
  for (int32_t c = 0; c < kCells; ++c)
    candidates.add(std::vector<int64_t>{0, -kLogOne}, kWords, std::vector<int64_t>(2));
  int breaths = 0;
  likeliestLabels(candidates, 0, [&] { ++breaths; });
  EXPECT_EQ(breaths, 4);
}

}  // namespace
}  // namespace shoal::topics
