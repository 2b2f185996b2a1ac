// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/k_means.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "shoal/random.h"
#include "shoal/vision/dense_search.h"

namespace shoal::vision {
namespace {

// `per_cluster` points in a square of side 2 r + 1 around each centre.
std::vector<int16_t> pointsAround(const std::vector<std::pair<int, int>>& centres, int per_cluster, int r,
                                  uint64_t seed) {
  Random random(seed);
  std::vector<int16_t> points;
  const auto noise = [&] { return static_cast<int>(random.below(static_cast<uint64_t>(2 * r + 1))) - r; };
  for (int i = 0; i < per_cluster; ++i) {
    for (const auto& [x, y] : centres) {
      points.push_back(static_cast<int16_t>(x + noise()));
      points.push_back(static_cast<int16_t>(y + noise()));
    }
  }
  return points;
}

TEST(KMeansTest, FindsPlantedClusters) {
  const std::vector<std::pair<int, int>> centres{{-1000, 40}, {-300, -900}, {0, 0}, {500, 500}, {900, -20}};
  const auto points = pointsAround(centres, 200, 30, 1);
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const auto result = kMeans(points, 2, {.num_words = 5, .max_rounds = 50, .seed = seed});
    ASSERT_EQ(result.words.size(), 10u);
    for (size_t k = 0; k < 5; ++k) {
      EXPECT_NEAR(result.words[2 * k], centres[k].first, 6) << "seed " << seed;
      EXPECT_NEAR(result.words[2 * k + 1], centres[k].second, 6) << "seed " << seed;
    }
  }
}

// With one word: its mean, rounded half away from 0.
TEST(KMeansTest, MakesAWordTheMeanOfItsMembers) {
  EXPECT_EQ(kMeans(std::vector<int16_t>{1, 2, 3, 4}, 1, {.num_words = 1, .max_rounds = 9, .seed = 1}).words,
            std::vector<int16_t>{3});  // 2.5
  EXPECT_EQ(
      kMeans(std::vector<int16_t>{-1, -2, -3, -4}, 1, {.num_words = 1, .max_rounds = 9, .seed = 1}).words,
      std::vector<int16_t>{-3});
  EXPECT_EQ(
      kMeans(std::vector<int16_t>{0, 9, 4, 9, 1, 9}, 2, {.num_words = 1, .max_rounds = 9, .seed = 1}).words,
      (std::vector<int16_t>{2, 9}));  // 5/3
}

TEST(KMeansTest, NeverGetsWorseFromRoundToRound) {
  const auto points = pointsAround({{0, 0}, {300, 100}, {-200, 500}}, 400, 400, 3);
  double previous = 1e18;
  int rounds = 0;
  const auto result = kMeans(points, 2, {.num_words = 12, .max_rounds = 100, .seed = 4},
                             [&](int round, int64_t changed, double distance) {
                               EXPECT_EQ(round, ++rounds);
                               EXPECT_GE(changed, 0);
                               EXPECT_LE(distance, previous + 1.0);  // rounding a word to integers costs that
                               previous = distance;
                             });
  EXPECT_EQ(result.rounds, rounds);
  EXPECT_LT(rounds, 100);  // it ends because nothing changes
}

TEST(KMeansTest, IsAFunctionOfPointsAndSeed) {
  const auto points = pointsAround({{0, 0}, {300, 100}}, 300, 200, 5);
  const auto words = [&](uint64_t seed) {
    return kMeans(points, 2, {.num_words = 20, .max_rounds = 5, .seed = seed}).words;
  };
  EXPECT_EQ(words(1), words(1));
  EXPECT_NE(words(1), words(2));
}

// As many words as distinct points: every point becomes a word, in order.
TEST(KMeansTest, MayTakeEveryPoint) {
  const std::vector<int16_t> points{5, 5, 5, 1, 1, 9, 9, 9, 9, 7};
  const auto result = kMeans(points, 1, {.num_words = 4, .max_rounds = 20, .seed = 1});
  EXPECT_EQ(result.words, (std::vector<int16_t>{1, 5, 7, 9}));
  EXPECT_EQ(result.mean_squared_distance, 0.0);
}

TEST(KMeansTest, RefusesWhatCannotBe) {
  const std::vector<int16_t> points{1, 1, 2};
  EXPECT_THROW(kMeans(points, 1, {.num_words = 3, .max_rounds = 20, .seed = 1}), std::invalid_argument);
  EXPECT_THROW(kMeans(points, 1, {.num_words = 0, .max_rounds = 20, .seed = 1}), std::invalid_argument);
  EXPECT_THROW(kMeans(points, 1, {.num_words = 1, .max_rounds = 0, .seed = 1}), std::invalid_argument);
  EXPECT_THROW(kMeans({}, 1, {.num_words = 1, .max_rounds = 1, .seed = 1}), std::invalid_argument);
}

}  // namespace
}  // namespace shoal::vision
