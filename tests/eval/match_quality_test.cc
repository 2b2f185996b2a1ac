// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/match_quality.h"

#include <gtest/gtest.h>

#include <vector>

#include "shoal/random.h"

namespace shoal::eval {
namespace {

// A tally of topics with one cell each of these classes; -1: without truth.
TeamTally topicsOf(const std::vector<int>& classes) {
  TeamTally tally;
  for (const int c : classes) {
    TopicTally topic{.robot = {},
                     .topic = world::TopicId{static_cast<int32_t>(tally.topics.size())},
                     .cells_of_class = {},
                     .cells = 1};
    topic.cells_of_class.resize(6);
    if (c >= 0) topic.cells_of_class[static_cast<size_t>(c)] = 1;
    tally.topics.push_back(topic);
  }
  tally.num_classes = 6;
  return tally;
}

// Labels aab|bbc... : pairs under one label 3 + 3, of one class 3 + 3 of 15 in all, 1 + 1 of them both. By
// scikit-learn: adjusted_rand_score([0,0,0,1,1,1],[0,0,1,1,2,2]) = 0.24242424...
TEST(MatchQualityTest, CountsPairsOfTopics) {
  const MatchQuality q = matchQuality(topicsOf({0, 0, 0, 1, 1, 1}), std::vector<int>{0, 0, 1, 1, 2, 2});
  EXPECT_NEAR(q.ari, 0.24242424242424243, 1e-12);
  EXPECT_NEAR(q.precision, 2.0 / 3, 1e-12);
  EXPECT_NEAR(q.recall, 2.0 / 6, 1e-12);
  EXPECT_NEAR(q.f1, 4.0 / 9, 1e-12);
}

TEST(MatchQualityTest, TopicsWithoutTruthDoNotCount) {
  const MatchQuality q = matchQuality(topicsOf({0, -1, 0, 1}), std::vector<int>{7, 7, 7, 8});
  EXPECT_EQ(q, (MatchQuality{1, 1, 1, 1}));
}

TEST(MatchQualityTest, NothingToMatchIsMatchedWell) {
  EXPECT_EQ(matchQuality(topicsOf({}), {}), (MatchQuality{1, 1, 1, 1}));
  EXPECT_EQ(matchQuality(topicsOf({3}), std::vector<int>{0}), (MatchQuality{1, 1, 1, 1}));
  EXPECT_EQ(matchQuality(topicsOf({0, 1}), std::vector<int>{0, 1}), (MatchQuality{1, 1, 1, 1}));
}

// Pairs counted one by one; the index of random labels is 0 in the mean.
TEST(MatchQualityTest, IsWhatPairsSay) {
  Random random(4);
  double mean = 0;
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<int> classes, labels;
    for (int i = 0; i < 40; ++i) {
      classes.push_back(static_cast<int>(random.below(5)));
      labels.push_back(static_cast<int>(random.below(6)));
    }
    double told = 0, alike = 0, right = 0;
    for (size_t i = 0; i < classes.size(); ++i) {
      for (size_t j = 0; j < i; ++j) {
        told += labels[i] == labels[j];
        alike += classes[i] == classes[j];
        right += labels[i] == labels[j] && classes[i] == classes[j];
      }
    }
    const MatchQuality q = matchQuality(topicsOf(classes), labels);
    EXPECT_DOUBLE_EQ(q.precision, right / told);
    EXPECT_DOUBLE_EQ(q.recall, right / alike);
    EXPECT_NEAR(q.f1, 2 / (1 / q.precision + 1 / q.recall), 1e-12);
    mean += q.ari / 200;
  }
  EXPECT_NEAR(mean, 0, 0.02);
}

}  // namespace
}  // namespace shoal::eval
