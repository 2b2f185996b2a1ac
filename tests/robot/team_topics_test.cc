// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/robot/team_topics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "shoal/mapping/belief_pieces.h"
#include "shoal/mapping/edit.h"
#include "shoal/topics/cell_label_model.h"

namespace shoal::robot {
namespace {

using mapping::BeliefStore;
using mapping::LocalBelief;
using mapping::Piece;
using topics::TeamTopics;
using world::RobotId;
using world::TopicId;

const std::vector<world::WordGroup> kGroups = {{"g", 0, 10}, {"h", 10, 10}};
const matching::MatcherOptions kMatcher = {.matcher = "clear", .similarity = "cosine"};

// R00's topics 1 and 2 are like R01's 4 and 5; R02's topic 9 is like nobody's.
std::vector<LocalBelief> team() {
  const auto robot = [](int number, std::vector<mapping::BelievedTopic> topics) {
    LocalBelief belief{RobotId{number}, {0, 9}, kGroups, std::move(topics), {}};
    for (const mapping::BelievedTopic& topic : belief.topics)
      belief.cells.push_back({{world::number(topic.id), number, 0}, topic.id, {1}, 1.f});
    return belief;
  };
  return {robot(0, {{TopicId{1}, {0}, 16, {{3, 8}, {12, 8}}}, {TopicId{2}, {0}, 10, {{5, 5}, {15, 5}}}}),
          robot(1, {{TopicId{4}, {0}, 16, {{3, 7}, {12, 9}}}, {TopicId{5}, {0}, 10, {{5, 6}, {15, 4}}}}),
          robot(2, {{TopicId{9}, {0}, 20, {{8, 10}, {18, 10}}}})};
}

std::vector<Piece> piecesOf(const std::vector<LocalBelief>& beliefs) {
  std::vector<Piece> pieces;
  for (const LocalBelief& belief : beliefs)
    for (const Piece& piece : mapping::wholePieces(belief)) pieces.push_back(piece);
  return pieces;
}

BeliefStore storeOf(const std::vector<Piece>& pieces) {
  BeliefStore store;
  for (const Piece& piece : pieces) store.apply(piece);
  return store;
}

TEST(TeamTopicsTest, TopicsThatAreMatchedAreOneLabel) {
  const TeamTopics known = teamTopics(storeOf(piecesOf(team())), RobotId{0}, kMatcher);
  ASSERT_EQ(known.own.size(), 2u);
  ASSERT_EQ(known.others.size(), 3u);  // by robot, then topic
  EXPECT_EQ(known.others[0].words, (std::vector<world::WordCount>{{3, 7}, {12, 9}}));
  EXPECT_EQ(known.others[0].robot, RobotId{1});
  EXPECT_EQ(known.others[2].robot, RobotId{2});
  EXPECT_EQ(known.others[0].label, known.own.at(TopicId{1}));
  EXPECT_EQ(known.others[1].label, known.own.at(TopicId{2}));
  EXPECT_NE(known.own.at(TopicId{1}), known.own.at(TopicId{2}));
  EXPECT_NE(known.others[2].label, known.own.at(TopicId{1}));
  EXPECT_NE(known.others[2].label, known.own.at(TopicId{2}));
}

// Who looks again tells other cells: who looks after it must still see the same.
TEST(TeamTopicsTest, WhatIsSaidOfCellsDoesNotMatter) {
  const TeamTopics known = teamTopics(storeOf(piecesOf(team())), RobotId{0}, kMatcher);
  std::vector<LocalBelief> later = team();
  for (mapping::BelievedCell& cell : later[1].cells) cell.topic = TopicId{4};  // none is topic 5 any more
  later[1].version.observation = 10;
  std::vector<Piece> pieces = piecesOf(later);
  EXPECT_EQ(teamTopics(storeOf(pieces), RobotId{0}, kMatcher), known);
  std::erase_if(pieces, [](const Piece& piece) { return piece.key.kind != mapping::PieceKind::kTopic; });
  EXPECT_EQ(teamTopics(storeOf(pieces), RobotId{0}, kMatcher), known);
}

TEST(TeamTopicsTest, TheOrderOfHearingDoesNotMatter) {
  std::vector<Piece> pieces = piecesOf(team());
  const TeamTopics known = teamTopics(storeOf(pieces), RobotId{1}, kMatcher);
  std::ranges::reverse(pieces);
  EXPECT_EQ(teamTopics(storeOf(pieces), RobotId{1}, kMatcher), known);
}

TEST(TeamTopicsTest, OperatorsDecide) {
  std::vector<Piece> pieces = piecesOf(team());
  const mapping::Edit edit{{"OPERATOR", 1}, {5}, mapping::ExcludeEdit{RobotId{1}}};
  pieces.push_back(mapping::pieceOf(edit));
  const TeamTopics known = teamTopics(storeOf(pieces), RobotId{0}, kMatcher);
  ASSERT_EQ(known.others.size(), 1u);
  EXPECT_EQ(known.own.size(), 2u);
  EXPECT_EQ(teamTopics(storeOf(pieces), RobotId{1}, kMatcher), TeamTopics{});  // who is out knows nothing
}

// What a broken robot says must not end the others.
TEST(TeamTopicsTest, NoTopicHasMoreWordsThanALearnerTakes) {
  std::vector<Piece> pieces = piecesOf(team());
  for (Piece& piece : pieces) {
    if (piece.key.robot != RobotId{1} || piece.key.kind != mapping::PieceKind::kTopic) continue;
    auto& part = std::get<mapping::TopicPart>(piece.content);
    for (world::WordCount& w : part.words) w.count = part.words.front().word == 3 ? 1 << 29 : INT32_MAX;
  }
  const TeamTopics known = teamTopics(storeOf(pieces), RobotId{0}, kMatcher);
  ASSERT_EQ(known.others.size(), 2u);  // 2^30 words may be
  topics::CellLabelModel model({}, kGroups, 1, RobotId{0});
  EXPECT_NO_THROW(model.lookAgain(known));
}

TEST(TeamTopicsTest, OtherSettingsAreNotCompared) {
  std::vector<Piece> pieces = piecesOf(team());
  for (int robot = 0; robot < 3; ++robot)
    pieces.push_back(mapping::pieceOf(
        RobotId{robot}, 0, {.words = robot == 2 ? 1u : 2u, .hyperparameters = 3, .cell_size_m = 1}));
  EXPECT_EQ(teamTopics(storeOf(pieces), RobotId{0}, kMatcher).others.size(), 2u);
  EXPECT_EQ(teamTopics(storeOf(pieces), RobotId{2}, kMatcher), TeamTopics{});
}

}  // namespace
}  // namespace shoal::robot
