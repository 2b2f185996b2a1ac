// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/belief_pieces.h"

#include <gtest/gtest.h>

#include "shoal/mapping/belief_store.h"

namespace shoal::mapping {
namespace {

LocalBelief belief(int observation) {
  return {
      .robot = world::RobotId{2},
      .version = {0, observation},
      .groups = {{"a", 0, 10}},
      .topics = {{world::TopicId{0}, {0}, 30, {{1, 30}}}, {world::TopicId{4}, {5}, 20, {{2, 20}}}},
      .cells = {{{-1, 0, 0}, world::TopicId{0}, {1000}, 0.5f}, {{0, 0, 0}, world::TopicId{4}, {1000}, 1.f}}};
}

TEST(QuantizeTest, RoundsToAHundredthOfTheGroupsNorm) {
  // Group one: counts 3, 4: norm 5, steps of .05: 60 and 80. Group two: 1 word: 100. By hand.
  const std::vector<world::WordGroup> groups{{"one", 0, 10}, {"two", 10, 5}};
  EXPECT_EQ(quantize({{0, 3}, {9, 4}, {12, 7}}, groups),
            (std::vector<world::WordCount>{{0, 60}, {9, 80}, {12, 100}}));
}

TEST(QuantizeTest, LeavesOutWhatRoundsToNothing) {
  // Norm of (1000, 1) is 1000.0005: 1 / 10 rounds to 0.
  EXPECT_EQ(quantize({{0, 1000}, {1, 1}}, {{"g", 0, 2}}), (std::vector<world::WordCount>{{0, 100}}));
}

TEST(WholePiecesTest, OnePieceATopicAndTwoABrick) {
  const auto pieces = wholePieces(belief(7));
  ASSERT_EQ(pieces.size(), 6u);  // two topics; the cells -1 and 0 lie in two bricks
  for (const Piece& piece : pieces) {
    EXPECT_EQ(piece.version, (world::Version{0, 7}));
    EXPECT_EQ(piece.num_parts, 1);
  }
  EXPECT_EQ(pieces[2].key.index, (std::array<int32_t, 3>{-1, 0, 0}));
}

TEST(BeliefChangesTest, SendsOnlyWhatChanged) {
  BeliefChanges changes;
  EXPECT_EQ(changes.update(belief(0)).size(), 6u);
  EXPECT_TRUE(changes.update(belief(1)).empty());
  LocalBelief next = belief(2);
  next.cells[1].certainty = 0.25f;
  const auto changed = changes.update(next);
  ASSERT_EQ(changed.size(), 1u);
  EXPECT_EQ(changed[0].key.kind, PieceKind::kCertainty);
  EXPECT_EQ(changed[0].version.observation, 2);
}

TEST(BeliefChangesTest, SaysOnceThatATopicIsGone) {
  BeliefChanges changes;
  changes.update(belief(0));
  LocalBelief next = belief(1);
  next.topics.pop_back();
  const auto changed = changes.update(next);
  ASSERT_EQ(changed.size(), 1u);
  EXPECT_EQ(std::get<TopicPart>(changed[0].content), (TopicPart{{0}, 0, {10}, {}}));
  next.version.observation = 2;
  EXPECT_TRUE(changes.update(next).empty());
}

TEST(BeliefChangesTest, ChangesAddUpToTheWhole) {
  BeliefChanges changes;
  BeliefStore by_changes;
  for (int i = 0; i < 4; ++i) {
    LocalBelief step = belief(i);
    step.topics[0].weight += i;
    step.cells[0].seen.us += i;
    for (const Piece& piece : changes.update(step)) by_changes.apply(piece);
  }
  std::vector<TopicPart> topics;
  by_changes.visit([&](const Piece& piece) {
    if (const auto* part = std::get_if<TopicPart>(&piece.content)) topics.push_back(*part);
  });
  ASSERT_EQ(topics.size(), 2u);
  EXPECT_EQ(topics[0].weight, 33);
}

}  // namespace
}  // namespace shoal::mapping
