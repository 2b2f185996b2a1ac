// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "shoal/random.h"
#include "shoal/topics/topic_model.h"

namespace shoal::topics {
namespace {

constexpr int32_t kVocabulary = 20;

// A row of cells whose words are all `word` or its neighbour.
world::WordsInCells row(int32_t observation, int32_t word, int32_t y) {
  world::WordsInCells words{.observation = observation, .time = {observation * 1'000'000LL}, .cells = {}};
  for (int32_t x = 0; x < 6; ++x) words.cells.push_back({{x, y, 0}, {{word, 7}, {word + 1, 5}}});
  return words;
}

Hyperparameters hyperparameters() {
  return {.max_topics = 4, .alpha = 0.1, .beta = 0.1, .resamples_per_observation = 2000};
}

int64_t wordsIn(const Snapshot& snapshot) {
  int64_t sum = 0;
  for (const TopicCounts& topic : snapshot.topics) {
    int64_t own = 0;
    for (const world::WordCount& w : topic.words) own += w.count;
    EXPECT_EQ(own, topic.weight);
    sum += own;
  }
  return sum;
}

TEST(AdoptTest, OwnCountsStayTheRobotsOwn) {
  TopicModel model(hyperparameters(), kVocabulary, 1, world::RobotId{0});
  model.observe(row(0, 0, 0));
  const std::vector<world::TopicId> ids = model.adopt({{std::nullopt, {{10, 500}, {11, 400}}}});
  ASSERT_EQ(ids.size(), 1u);
  EXPECT_GE(number(ids[0]), 0);
  EXPECT_EQ(wordsIn(model.snapshot()), 6 * 12);
  model.observe(row(1, 10, 4));
  EXPECT_EQ(wordsIn(model.snapshot()), 2 * 6 * 12);
  model.adopt({});
  EXPECT_EQ(wordsIn(model.snapshot()), 2 * 6 * 12);
}

// Words 10 and 11 are known from others as one topic: what this robot then sees of them gets its name.
TEST(AdoptTest, WhatOthersKnowNamesWhatIsSeenLater) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    TopicModel model(hyperparameters(), kVocabulary, seed, world::RobotId{0});
    model.observe(row(0, 0, 0));
    const world::TopicId known = model.adopt({{std::nullopt, {{10, 500}, {11, 400}}}})[0];
    model.observe(row(1, 10, 4));
    for (const CellLabel& cell : model.snapshot().cells) {
      EXPECT_EQ(cell.topic == known, cell.cell.y == 4) << "seed " << seed << ", cell " << cell.cell.x;
    }
  }
}

TEST(AdoptTest, AdoptingAgainReplacesAndKeepsTheName) {
  TopicModel model(hyperparameters(), kVocabulary, 1, world::RobotId{0});
  model.observe(row(0, 0, 0));
  const world::TopicId known = model.adopt({{std::nullopt, {{10, 500}}}})[0];
  EXPECT_EQ(model.adopt({{known, {{10, 9}, {12, 3}}}})[0], known);
  const int32_t open = model.numTopics();
  model.adopt({});
  EXPECT_EQ(model.numTopics(), open - 1);  // it had no words of this robot
  EXPECT_THROW(model.adopt({{known, {{10, 1}}}}), std::invalid_argument);
}

TEST(AdoptTest, WithoutAFreeSlotATopicIsLeftOut) {
  TopicModel model(hyperparameters(), kVocabulary, 1, world::RobotId{0});
  std::vector<AdoptedTopic> others;
  for (int32_t w = 0; w < 5; ++w) others.push_back({std::nullopt, {{w, 10}}});
  const std::vector<world::TopicId> ids = model.adopt(others);
  EXPECT_EQ(std::ranges::count(ids, world::TopicId{-1}), 1);
}

TEST(AdoptTest, RefusesWordsOutOfOrderOrRange) {
  TopicModel model(hyperparameters(), kVocabulary, 1, world::RobotId{0});
  EXPECT_THROW(model.adopt({{std::nullopt, {{3, 1}, {3, 1}}}}), std::invalid_argument);
  EXPECT_THROW(model.adopt({{std::nullopt, {{kVocabulary, 1}}}}), std::invalid_argument);
  EXPECT_THROW(model.adopt({{world::TopicId{7}, {{1, 1}}}}), std::invalid_argument);
}

}  // namespace
}  // namespace shoal::topics
