// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/label_conditional.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "shoal/topics/fixed_log.h"

namespace shoal::topics {
namespace {

std::vector<uint64_t> weights(const std::vector<double>& natural_logs, const std::vector<int32_t>& alike,
                              double evidence, double coupling) {
  std::vector<int64_t> logs;
  for (const double log : natural_logs) logs.push_back(std::llround(log / std::log(2.0) * kLogOne));
  std::vector<uint64_t> result(logs.size());
  weighLabels(logs, 100, alike, ConditionalScale::of(evidence, coupling), result);
  return result;
}

// exp(10 / 100 ln L + 1.5 m), worked in floating point; 100 words that are worth 10.
TEST(LabelConditionalTest, IsTheTemperedLikelihoodTimesThePottsPrior) {
  const std::vector<double> logs = {-300, -280, -310.5, -250};
  const std::vector<int32_t> alike = {2, 0, 4, kNotALabel};
  const auto drawn = weights(logs, alike, 10, 1.5);
  std::vector<double> expected;
  for (size_t k = 0; k < 3; ++k) expected.push_back(std::exp(0.1 * logs[k] + 1.5 * alike[k]));
  const double largest = *std::ranges::max_element(expected);
  EXPECT_EQ(*std::ranges::max_element(drawn), uint64_t{1} << 32);
  EXPECT_EQ(drawn[3], 0u);
  for (size_t k = 0; k < 3; ++k) {
    const double share = static_cast<double>(drawn[k]) / 4294967296.0;
    EXPECT_NEAR(share / (expected[k] / largest), 1.0, 1e-3) << k;  // e and J are rounded to 2^-16
  }
}

// What is drawn most often of what may be drawn, ties to the lowest.
TEST(LabelConditionalTest, TheLikeliestHasTheGreatestWeight) {
  Random random(5);
  for (int trial = 0; trial < 500; ++trial) {
    std::vector<int64_t> logs;
    std::vector<int32_t> alike;
    for (int k = 0; k < 6; ++k) {
      logs.push_back(-static_cast<int64_t>(random.below(40)) * kLogOne * 10);
      alike.push_back(static_cast<int32_t>(random.below(5)) - 1);
    }
    alike[random.below(6)] = 0;
    const auto scale = ConditionalScale::of(10, 0.5);
    std::vector<uint64_t> weight(6);
    weighLabels(logs, 100, alike, scale, weight);
    EXPECT_EQ(likeliestLabel(logs, 100, alike, scale), std::ranges::max_element(weight) - weight.begin());
  }
}

// Words never count for more than they are.
TEST(LabelConditionalTest, FewWordsAreWorthWhatTheyAre) {
  const std::vector<double> logs = {-3, -1, -2};
  const std::vector<int32_t> alike = {1, 0, 0};
  EXPECT_EQ(weights(logs, alike, 100, 1), weights(logs, alike, 1e6, 1));
  EXPECT_NE(weights(logs, alike, 99, 1), weights(logs, alike, 1e6, 1));
}

TEST(LabelConditionalTest, WhatIsHopelessIsNeverDrawn) {
  const auto drawn = weights({-1e9, 0, -1e9}, {6, 0, 6}, 100.0, 100.0);
  EXPECT_EQ(drawn, (std::vector<uint64_t>{0, uint64_t{1} << 32, 0}));
}

// Without words and neighbours all labels are alike, of however many cells.
TEST(LabelConditionalTest, KnowsNoPopularity) {
  const auto drawn = weights({0, 0, 0}, {0, 0, kNotALabel}, 10, 1.0);
  EXPECT_EQ(drawn[0], drawn[1]);
  EXPECT_EQ(drawn[2], 0u);
}

// Five standard deviations of the binomial.
TEST(LabelConditionalTest, DrawsInProportion) {
  const std::vector<uint64_t> weight = {0, uint64_t{1} << 32, 0, uint64_t{3} << 30, uint64_t{1} << 30};
  std::vector<int> drawn(weight.size());
  for (uint64_t i = 0; i < 20'000; ++i) {
    Random random(5, i);
    ++drawn[static_cast<size_t>(drawLabel(weight, random))];
  }
  EXPECT_EQ(drawn[0] + drawn[2], 0);
  EXPECT_NEAR(drawn[1], 10'000, 5 * std::sqrt(20'000 * 0.5 * 0.5));
  EXPECT_NEAR(drawn[3], 7'500, 5 * std::sqrt(20'000 * 0.375 * 0.625));
}

}  // namespace
}  // namespace shoal::topics
