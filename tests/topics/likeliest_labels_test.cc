// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/likeliest_labels.h"

#include <gtest/gtest.h>

#include <cstdint>
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
    likelihoods.num_labels = static_cast<int32_t>(bits.front().size());
    for (size_t c = 0; c < bits.size(); ++c) {
      neighborhood.insert({static_cast<int32_t>(c), 0, 0});
      likelihoods.num_words.push_back(kWords);
      for (const double b : bits[c]) likelihoods.log_likelihoods.push_back(static_cast<int64_t>(b * kLogOne));
    }
  }
  std::vector<int32_t> likeliest(int rounds) const {
    return likeliestLabels(likelihoods, neighborhood, kScale, rounds);
  }

  LabelLikelihoods likelihoods;
  Neighborhood neighborhood;
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

TEST(LikeliestLabelsTest, TiesGoToTheLowest) { EXPECT_EQ(Row({{0, 0, 0}}).likeliest(3), Labels{0}); }

// Besag 1986: no round makes the labels less likely, and when nothing changes any more each cell has the
// likeliest label that it can have beside its neighbours. By the definition, in floating point.
TEST(LikeliestLabelsTest, EveryRoundIsAtLeastAsLikelyAndTheLastIsAMode) {
  Random random(4);
  for (int trial = 0; trial < 60; ++trial) {
    constexpr int32_t kSide = 6, kLabels = 4;
    LabelLikelihoods likelihoods{.num_labels = kLabels, .log_likelihoods = {}, .num_words = {}};
    Neighborhood neighborhood;
    for (int32_t c = 0; c < kSide * kSide; ++c) {
      neighborhood.insert({c / kSide, c % kSide, 0});
      likelihoods.num_words.push_back(kWords);
      for (int32_t k = 0; k < kLabels; ++k)
        likelihoods.log_likelihoods.push_back(-static_cast<int64_t>(random.below(50 * kLogOne)));
    }
    const auto words = [&](int32_t c, int32_t k) {
      return static_cast<double>(likelihoods.of(c)[static_cast<size_t>(k)]) / kLogOne * 0.1;
    };
    const auto alike = [&](const Labels& labels, int32_t c, int32_t k) {
      int32_t votes = 0;
      for (const int32_t n : neighborhood.of(c)) votes += labels[static_cast<size_t>(n)] == k;
      return votes * 1.4426950408889634;
    };
    double last = -1e9;
    Labels labels;
    for (const int rounds : {0, 1, 2, 3, 100}) {
      labels = likeliestLabels(likelihoods, neighborhood, kScale, rounds);
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

}  // namespace
}  // namespace shoal::topics
