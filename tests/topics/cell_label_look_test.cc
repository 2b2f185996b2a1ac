// SPDX-License-Identifier: BSD-3-Clause
// CellLabelModel::lookAgain().
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <vector>

#include "planted_map.h"
#include "shoal/topics/cell_label_model.h"
#include "shoal/topics/topic_model.h"

namespace shoal::topics {
namespace {

using world::CellIndex;
using world::RobotId;
using world::TopicId;
using world::WordCount;

const CellLabelHyperparameters kKnobs = {.max_topics = 6, .cells_per_topic = 8};

// One robot's map after some images of a planted map of three classes.
CellLabelModel learnt(int32_t images = 10, uint64_t seed = 1) {
  CellLabelModel model(kKnobs, PlantedMap::groups(), seed, RobotId{0});
  PlantedMap map(3, 3);
  for (int32_t i = 0; i < images; ++i) model.observe(map.image(i));
  return model;
}

// Every topic under a label of its own.
TeamTopics alone(const Snapshot& snapshot) {
  TeamTopics team;
  for (const TopicCounts& topic : snapshot.topics) team.own[topic.id] = 100 + number(topic.id);
  return team;
}

std::map<CellIndex, TopicId> topicsOf(const Snapshot& snapshot) {
  std::map<CellIndex, TopicId> topics;
  for (const CellLabel& cell : snapshot.cells) topics[cell.cell] = cell.topic;
  return topics;
}

std::vector<std::pair<TopicId, std::vector<WordCount>>> countsOf(const Snapshot& snapshot) {
  std::vector<std::pair<TopicId, std::vector<WordCount>>> counts;
  for (const TopicCounts& topic : snapshot.topics) counts.emplace_back(topic.id, topic.words);
  return counts;
}

TEST(CellLabelLookTest, OnlyWhatIsToldOfCellsChanges) {
  CellLabelModel model = learnt(), other = model;
  const Snapshot before = model.snapshot();
  TeamTopics team = alone(before);
  ASSERT_GE(before.topics.size(), 2u);
  team.others.push_back({RobotId{1}, team.own.at(before.topics[0].id), before.topics[1].words});
  model.lookAgain(team);
  const Snapshot after = model.snapshot();
  EXPECT_NE(topicsOf(after), topicsOf(before));
  EXPECT_EQ(countsOf(after), countsOf(before));
  EXPECT_EQ(model.drawnTopics(), other.drawnTopics());
  ASSERT_EQ(after.cells.size(), before.cells.size());
  for (size_t c = 0; c < after.cells.size(); ++c) {
    EXPECT_EQ(after.cells[c].seen, before.cells[c].seen);
    EXPECT_EQ(after.cells[c].surprise, before.cells[c].surprise);
    EXPECT_GT(after.cells[c].certainty, 0);
    EXPECT_LT(after.cells[c].certainty, 1);
  }
  // The chain goes on as if nothing had been.
  PlantedMap map(3, 3);
  for (int32_t i = 0; i < 10; ++i) map.image(i);
  const world::WordsInCells next = map.image(10);
  model.observe(next);
  other.observe(next);
  EXPECT_EQ(countsOf(model.snapshot()), countsOf(other.snapshot()));
  EXPECT_EQ(model.drawnTopics(), other.drawnTopics());
}

// A topic of the team knows words that are missing in the robot's own topic of that label: a cell that has
// them is of that label then.
TEST(CellLabelLookTest, ATopicSpeaksWithTheWordsOfAllOfItsLabel) {
  const std::vector<world::WordGroup> groups = {{.name = "all", .first = 0, .size = 30}};
  CellLabelModel model({.max_topics = 2, .cells_per_topic = 2, .coupling = 0, .twin_similarity = 1}, groups,
                       1, RobotId{0});
  // Two cells of words 0 to 4, two of words 10 to 14, far from each other; the last has some words of the
  // second kind and many that this robot has nowhere else.
  const auto cell = [](int32_t x, int32_t first, int32_t count) {
    world::CellWords words{{x, 0, 0}, {}};
    for (int32_t w = first; w < first + 5; ++w) words.words.push_back({w, count});
    return words;
  };
  world::CellWords odd{{40, 0, 0}, {}};
  for (int32_t w = 10; w < 15; ++w) odd.words.push_back({w, 2});
  for (int32_t w = 20; w < 25; ++w) odd.words.push_back({w, 8});
  for (int32_t i = 0; i < 6; ++i) {
    model.observe({.observation = i,
                   .time = {i * 1'000'000LL},
                   .cells = {cell(0, 0, 20), cell(10, 0, 20), cell(20, 10, 20), cell(30, 10, 20), odd}});
  }
  const auto told = [&] { return topicsOf(model.snapshot()); };
  const TopicId first = told().at({0, 0, 0}), second = told().at({20, 0, 0});
  ASSERT_NE(first, second);
  TeamTopics team;
  team.own = {{first, 7}, {second, 8}};
  model.lookAgain(team);
  ASSERT_EQ(told().at({40, 0, 0}), second);  // its own other words decide
  team.others = {{RobotId{1}, 7, {{20, 200}, {21, 200}, {22, 200}, {23, 200}, {24, 200}}}};
  model.lookAgain(team);
  EXPECT_EQ(told().at({40, 0, 0}), first);
  EXPECT_EQ(told().at({0, 0, 0}), first);
  EXPECT_EQ(told().at({30, 0, 0}), second);
  // Under a label of which this robot has no topic it says nothing.
  team.others[0].label = 9;
  model.lookAgain(team);
  EXPECT_EQ(told().at({40, 0, 0}), second);
}

// Two own topics of one label: a cell of either stays what it was told as.
TEST(CellLabelLookTest, OwnTopicsOfOneLabelAreOneToIt) {
  CellLabelHyperparameters smooth = kKnobs;  // neighbours have outvoted the words of some cells
  smooth.evidence = 1;
  CellLabelModel model(smooth, PlantedMap::groups(), 1, RobotId{0});
  PlantedMap map(3, 3);
  for (int32_t i = 0; i < 10; ++i) model.observe(map.image(i));
  const Snapshot before = model.snapshot();
  ASSERT_GE(before.topics.size(), 2u);
  TeamTopics team;
  for (const TopicCounts& topic : before.topics) team.own[topic.id] = 5;
  model.lookAgain(team);
  EXPECT_EQ(topicsOf(model.snapshot()), topicsOf(before));
}

// Topics that the team has no label of are not mixed with each other.
TEST(CellLabelLookTest, WithoutATeamEachTopicStandsForItself) {
  CellLabelModel model = learnt(), other = model;
  model.lookAgain(alone(model.snapshot()));
  other.lookAgain({});
  EXPECT_EQ(topicsOf(model.snapshot()), topicsOf(other.snapshot()));
  EXPECT_GT(model.snapshot().topics.size(), 1u);
}

TEST(CellLabelLookTest, NeitherNumbersOfLabelsNorOrderMatter) {
  CellLabelModel model = learnt(), other = model;
  const Snapshot snapshot = model.snapshot();
  TeamTopics team = alone(snapshot), renamed;
  for (const TopicCounts& topic : learnt(12, 2).snapshot().topics) {
    const TopicId like = snapshot.topics[static_cast<size_t>(number(topic.id)) % snapshot.topics.size()].id;
    team.others.push_back({RobotId{2}, 100 + number(like), topic.words});
  }
  for (const auto& [topic, label] : team.own) renamed.own[topic] = 5000 - 7 * label;
  for (const auto& [robot, label, words] : team.others)
    renamed.others.insert(renamed.others.begin(), {RobotId{9 - number(robot)}, 5000 - 7 * label, words});
  model.lookAgain(team);
  other.lookAgain(renamed);
  const Snapshot a = model.snapshot(), b = other.snapshot();
  EXPECT_EQ(topicsOf(a), topicsOf(b));
  for (size_t c = 0; c < a.cells.size(); ++c) EXPECT_EQ(a.cells[c].certainty, b.cells[c].certainty);
}

// What the others know helps: a robot that has seen little of a planted map knows it better by the topics of
// one that has seen all of it, matched by their classes.
TEST(CellLabelLookTest, FindsMoreOfAPlantedMap) {
  constexpr int kSeeds = 20;
  double right_before = 0, right_after = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    PlantedMap map(static_cast<uint64_t>(seed), 4);
    const CellLabelHyperparameters knobs = {.max_topics = 8, .cells_per_topic = 6, .evidence = 3};
    CellLabelModel few(knobs, PlantedMap::groups(), 1, RobotId{0}),
        all(knobs, PlantedMap::groups(), 1, RobotId{1});
    for (int32_t i = 0; i < 2; ++i) few.observe(map.image(i));
    PlantedMap again(static_cast<uint64_t>(seed), 4);
    for (int32_t i = 0; i < PlantedMap::kSide - 1; ++i) all.observe(again.image(i));
    const auto majorities = [&](const Snapshot& s) {
      std::map<TopicId, std::map<int32_t, int>> met;
      for (const CellLabel& c : s.cells) ++met[c.topic][map.classOf(c.cell)];
      std::map<TopicId, int32_t> majority;
      for (const auto& [topic, classes] : met)
        majority[topic] =
            std::ranges::max_element(classes, {}, [](const auto& p) { return p.second; })->first;
      return majority;
    };
    const auto right = [&](const std::map<TopicId, int32_t>& majority) {
      const Snapshot s = few.snapshot();
      double n = 0;
      for (const CellLabel& c : s.cells) {
        const auto known = majority.find(c.topic);
        n += known != majority.end() && known->second == map.classOf(c.cell);
      }
      return n / static_cast<double>(s.cells.size());
    };
    TeamTopics team;
    const auto mine = majorities(few.snapshot()), theirs = majorities(all.snapshot());
    for (const auto& [topic, label] : mine) team.own[topic] = label;
    for (const TopicCounts& topic : all.snapshot().topics)
      if (theirs.contains(topic.id)) team.others.push_back({RobotId{1}, theirs.at(topic.id), topic.words});
    right_before += right(mine) / kSeeds;
    few.lookAgain(team);
    right_after += right(mine) / kSeeds;
  }
  EXPECT_GT(right_after, right_before + 0.01);
}

TEST(CellLabelLookTest, RefusesWordsThatItDoesNotHave) {
  CellLabelModel model = learnt(3);
  const auto look = [&](std::vector<WordCount> words) {
    model.lookAgain({.own = {}, .others = {{RobotId{1}, 0, std::move(words)}}});
  };
  EXPECT_THROW(look({{100, 1}}), std::invalid_argument);
  EXPECT_THROW(look({{-1, 1}}), std::invalid_argument);
  EXPECT_THROW(look({{5, 1}, {5, 1}}), std::invalid_argument);
  EXPECT_THROW(look({{5, 0}}), std::invalid_argument);
  EXPECT_THROW(look({{5, 1 << 30}, {6, 1}}), std::invalid_argument);
  EXPECT_NO_THROW(look({{99, 1}}));
}

// Before its cells are compared, and before they are told, beside what likeliestLabels() does.
TEST(CellLabelLookTest, BreathesAndEndsTheSame) {
  CellLabelModel model = learnt(), other = model;
  const TeamTopics team = alone(model.snapshot());
  int breaths = 0;
  model.lookAgain(team, [&] { ++breaths; });
  other.lookAgain(team);
  EXPECT_GE(breaths, 4);
  EXPECT_EQ(topicsOf(model.snapshot()), topicsOf(other.snapshot()));
}

TEST(CellLabelLookTest, AModelOfWordsCannot) {
  TopicModel model({}, 100, 1, RobotId{0});
  EXPECT_FALSE(model.canLookAgain());
  EXPECT_THROW(model.lookAgain({}), std::logic_error);
}

TEST(CellLabelLookTest, KnowsNothingBeforeTheFirstImage) {
  CellLabelModel model(kKnobs, PlantedMap::groups(), 1, RobotId{0});
  model.lookAgain({.own = {}, .others = {{RobotId{1}, 0, {{1, 1}}}}});
  EXPECT_TRUE(model.snapshot().cells.empty());
}

}  // namespace
}  // namespace shoal::topics
