// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/fusion.h"

#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "shoal/mapping/belief_pieces.h"
#include "shoal/random.h"

namespace shoal::mapping {
namespace {

using world::CellIndex;
using world::GlobalLabel;
using world::RobotId;
using world::TopicId;

BelievedTopic topic(int id, int64_t created_us, int32_t word) {
  return {TopicId{id}, {created_us}, 50, {{word, 50}}};
}

LocalBelief robot(int number, std::vector<BelievedTopic> topics, std::vector<BelievedCell> cells) {
  return {RobotId{number}, {0, 1}, {{"g", 0, 100}}, std::move(topics), std::move(cells)};
}

BeliefStore storeOf(const std::vector<LocalBelief>& beliefs) {
  BeliefStore store;
  for (const LocalBelief& b : beliefs)
    for (const Piece& piece : wholePieces(b)) store.apply(piece);
  return store;
}

GlobalLabel labelAt(const GlobalMap& map, CellIndex cell) {
  const auto found = std::ranges::find(map.cells, cell, &GlobalCell::cell);
  return found == map.cells.end() ? GlobalLabel{-1} : found->label;
}

// Robots 0 and 1 both know word 7 (topics 0 and 3) and each one thing of its own.
std::vector<LocalBelief> twoRobots() {
  return {robot(0, {topic(0, 20, 7), topic(1, 0, 8)},
                {{{0, 0, 0}, TopicId{0}, {100}, .5f}, {{1, 0, 0}, TopicId{1}, {100}, .5f}}),
          robot(1, {topic(2, 5, 9), topic(3, 10, 7)},
                {{{5, 0, 0}, TopicId{3}, {100}, .5f}, {{6, 0, 0}, TopicId{2}, {100}, .5f}})};
}

TEST(FuseTest, NamesALabelAfterItsOldestTopic) {
  const GlobalMap map = fuse(storeOf(twoRobots()), {});
  EXPECT_EQ(labelAt(map, {0, 0, 0}), GlobalLabel{10003});  // robot 1's topic 3 is older
  EXPECT_EQ(labelAt(map, {5, 0, 0}), GlobalLabel{10003});
  EXPECT_EQ(labelAt(map, {1, 0, 0}), GlobalLabel{1});
  EXPECT_EQ(labelAt(map, {6, 0, 0}), GlobalLabel{10002});
}

TEST(FuseTest, ACellShowsWhoSawItLastAndTheHigherRobotAmongEquals) {
  auto beliefs = twoRobots();
  beliefs[0].cells.push_back({{5, 0, 0}, TopicId{1}, {99}, 1.f});
  beliefs[0].cells.push_back({{6, 0, 0}, TopicId{1}, {101}, 1.f});
  beliefs[1].cells.insert(beliefs[1].cells.begin(), {{1, 0, 0}, TopicId{2}, {100}, 0.f});
  const GlobalMap map = fuse(storeOf(beliefs), {});
  EXPECT_EQ(labelAt(map, {5, 0, 0}), GlobalLabel{10003});  // robot 1 at 100 beats robot 0 at 99
  EXPECT_EQ(labelAt(map, {6, 0, 0}), GlobalLabel{1});      // robot 0 at 101 beats robot 1 at 100
  EXPECT_EQ(labelAt(map, {1, 0, 0}), GlobalLabel{10002});  // 100 and 100: robot 1
  EXPECT_FLOAT_EQ(map.cells.back().certainty, 1.f);        // the winner's own certainty
}

TEST(FuseTest, ATopicThatLabelsNothingStaysOutOfTheMatching) {
  auto beliefs = twoRobots();
  beliefs[1].topics.push_back(topic(4, 0, 7));  // older twin of the shared topic, on no cell
  const GlobalMap map = fuse(storeOf(beliefs), {});
  EXPECT_EQ(labelAt(map, {0, 0, 0}), GlobalLabel{10003});
}

TEST(FuseTest, ACellWhoseTopicIsUnheardKeepsItsRobotsOwnLabel) {
  auto beliefs = twoRobots();
  beliefs[1].topics.erase(beliefs[1].topics.begin());
  EXPECT_EQ(labelAt(fuse(storeOf(beliefs), {}), {6, 0, 0}), GlobalLabel{10002});
}

TEST(FuseTest, ARobotWithAnotherVocabularyIsShownNotMixed) {
  auto beliefs = twoRobots();
  beliefs.push_back(robot(2, {topic(0, 1, 7)}, {{{9, 0, 0}, TopicId{0}, {1}, 1.f}}));
  beliefs[2].groups = {{"g", 0, 99}};
  const GlobalMap map = fuse(storeOf(beliefs), {});
  EXPECT_EQ(labelAt(map, {9, 0, 0}), GlobalLabel{20000});
  EXPECT_EQ(labelAt(map, {0, 0, 0}), GlobalLabel{10003});
}

TEST(FuseTest, SummarisesEveryLabelThatHasCells) {
  const GlobalMap map = fuse(storeOf(twoRobots()), {});
  ASSERT_EQ(map.labels.size(), 3u);
  const LabelSummary& shared = map.labels.back();
  EXPECT_EQ(shared.label, GlobalLabel{10003});
  EXPECT_EQ(shared.cells, 2);
  EXPECT_EQ(shared.robots, (std::vector{RobotId{0}, RobotId{1}}));
  EXPECT_EQ(shared.first_seen.us, 10);
}

// A peer's parts may be valid each by itself and not together. The node must not fall over them.
TEST(FuseTest, PartsThatRepeatAWordOrDisagreeOnTheVocabularyHurtNobody) {
  BeliefStore store = storeOf(twoRobots());
  const auto part = [](int32_t index, std::vector<int32_t> layout, std::vector<world::WordCount> words) {
    return Piece{.key = {RobotId{2}, PieceKind::kTopic, {0, 0, 0}},
                 .version = {0, 1},
                 .part = index,
                 .num_parts = 3,
                 .content = TopicPart{{1}, 50, std::move(layout), std::move(words)}};
  };
  store.apply(part(0, {100}, {{7, 50}}));
  store.apply(part(1, {100}, {{7, 50}}));
  store.apply(part(2, {5000}, {{4000, 9}}));
  store.apply({.key = {RobotId{2}, PieceKind::kBrick, {0, 0, 0}},
               .version = {0, 1},
               .content = BrickPart{{{{9, 0, 0}, TopicId{0}, {1}}}}});
  EXPECT_EQ(labelAt(fuse(store, {}), {9, 0, 0}), GlobalLabel{20000});  // word 7, and the oldest that has it
  EXPECT_EQ(labelAt(fuse(store, {}), {0, 0, 0}), GlobalLabel{20000});
}

TEST(FuseTest, OfNothingIsNothing) {
  const GlobalMap map = fuse(BeliefStore{}, {});
  EXPECT_TRUE(map.cells.empty());
  EXPECT_TRUE(map.labels.empty());
}

// Whatever order pieces came in, the map is the same to the last bit.
TEST(FuseTest, IsAFunctionOfTheStateNotOfItsHistory) {
  std::vector<LocalBelief> beliefs;
  Random random(7);
  for (int r = 0; r < 4; ++r) {
    std::vector<BelievedTopic> topics;
    for (int t = 0; t < 4; ++t)
      topics.push_back(topic(t, static_cast<int64_t>(random.below(50)), t * 3 + r % 2));
    std::map<CellIndex, BelievedCell> cells;
    for (int i = 0; i < 300; ++i) {
      const CellIndex c{static_cast<int32_t>(random.below(40)) - 20,
                        static_cast<int32_t>(random.below(40)) - 20, 0};
      cells[c] = {c,
                  TopicId{static_cast<int32_t>(random.below(4))},
                  {static_cast<int64_t>(random.below(9))},
                  static_cast<float>(random.uniform())};
    }
    std::vector<BelievedCell> list;
    for (const auto& [index, c] : cells) list.push_back(c);
    beliefs.push_back(robot(r, topics, list));
  }
  std::vector<Piece> pieces;
  for (const LocalBelief& b : beliefs)
    for (Piece& piece : wholePieces(b)) pieces.push_back(std::move(piece));
  const GlobalMap expected = fuse(storeOf(beliefs), {});
  for (int trial = 0; trial < 20; ++trial) {
    for (size_t i = pieces.size(); i > 1; --i) std::swap(pieces[i - 1], pieces[random.below(i)]);
    BeliefStore store;
    for (const Piece& piece : pieces) store.apply(piece);
    const GlobalMap map = fuse(store, {});
    ASSERT_EQ(map.cells, expected.cells);
    ASSERT_EQ(map.digest(), expected.digest());
    ASSERT_EQ(map.state_digest, expected.state_digest);
  }
}

}  // namespace
}  // namespace shoal::mapping
