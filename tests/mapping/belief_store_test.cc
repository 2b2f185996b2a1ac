// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/belief_store.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "shoal/random.h"

namespace shoal::mapping {
namespace {

// Part `part` of `num_parts` of robot r's topic t as it was at observation `observation`.
Piece topicPiece(int r, int t, int observation, int part = 0, int num_parts = 1) {
  return {.key = {world::RobotId{r}, PieceKind::kTopic, {t, 0, 0}},
          .version = {0, observation},
          .part = part,
          .num_parts = num_parts,
          .content = TopicPart{{0}, 100 + observation, {50}, {{part * 10 + observation % 10, 3}}}};
}

std::vector<Piece> held(const BeliefStore& store) {
  std::vector<Piece> pieces;
  store.visit([&](const Piece& piece) { pieces.push_back(piece); });
  return pieces;
}

TEST(BeliefStoreTest, KeepsTheNewestVersion) {
  BeliefStore store;
  EXPECT_EQ(store.apply(topicPiece(0, 0, 5)), Applied::kNew);
  EXPECT_EQ(store.apply(topicPiece(0, 0, 4)), Applied::kOld);
  EXPECT_EQ(store.apply(topicPiece(0, 0, 5)), Applied::kDuplicate);
  EXPECT_EQ(store.apply(topicPiece(0, 0, 6)), Applied::kNew);
  EXPECT_EQ(held(store), std::vector{topicPiece(0, 0, 6)});
}

TEST(BeliefStoreTest, AGrownEpochBeatsAnyObservation) {
  BeliefStore store;
  store.apply(topicPiece(0, 0, 900));
  Piece reborn = topicPiece(0, 0, 1);
  reborn.version.epoch = 1;
  EXPECT_EQ(store.apply(reborn), Applied::kNew);
  EXPECT_EQ(held(store), std::vector{reborn});
}

// A robot that lost its disk gives its topics other meanings: what it said before is gone, in whatever order
// things are heard, and although nothing of the new epoch has the old one's name.
TEST(BeliefStoreTest, ANewEpochVoidsAllThatTheRobotSaidBefore) {
  Piece reborn = topicPiece(0, 7, 1);
  reborn.version.epoch = 1;
  std::vector<Piece> pieces = {topicPiece(0, 0, 900), topicPiece(0, 1, 901, 0, 2),
                               topicPiece(0, 1, 901, 1, 2), topicPiece(1, 0, 900), reborn};
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    BeliefStore store;
    for (const Piece& piece : pieces) store.apply(piece);
    EXPECT_EQ(held(store), (std::vector{reborn, topicPiece(1, 0, 900)}));
    EXPECT_EQ(store.digestOf(world::RobotId{0}), contentHash(reborn));
    EXPECT_EQ(store.apply(topicPiece(0, 0, 999)), Applied::kOld);
    std::ranges::shuffle(pieces, random);
  }
}

TEST(BeliefStoreTest, PartZeroAloneIsUsableAndPartsOfTwoVersionsNeverMix) {
  BeliefStore store;
  store.apply(topicPiece(0, 0, 1, 0, 2));
  store.apply(topicPiece(0, 0, 1, 1, 2));
  EXPECT_EQ(store.apply(topicPiece(0, 0, 2, 1, 2)), Applied::kPending);
  EXPECT_EQ(held(store), (std::vector{topicPiece(0, 0, 1, 0, 2), topicPiece(0, 0, 1, 1, 2)}));
  EXPECT_EQ(store.apply(topicPiece(0, 0, 3, 0, 2)), Applied::kNew);
  EXPECT_EQ(held(store), std::vector{topicPiece(0, 0, 3, 0, 2)});
}

TEST(BeliefStoreTest, TwoProcessesWithOneIdAreSeenAndKeptOut) {
  BeliefStore store;
  store.apply(topicPiece(0, 0, 5));
  Piece other = topicPiece(0, 0, 5);
  std::get<TopicPart>(other.content).weight += 1;
  const uint64_t digest = store.digest();
  EXPECT_EQ(store.apply(other), Applied::kConflict);
  Piece other_cut = topicPiece(0, 0, 5, 1, 3);
  EXPECT_EQ(store.apply(other_cut), Applied::kConflict);
  EXPECT_EQ(store.digest(), digest);
  EXPECT_EQ(held(store), std::vector{topicPiece(0, 0, 5)});
}

TEST(BeliefStoreTest, LimitsKeepAFloodOut) {
  BeliefStore store({.max_robots = 2, .max_pieces_per_robot = 3});
  for (int t = 0; t < 3; ++t) EXPECT_EQ(store.apply(topicPiece(0, t, 0)), Applied::kNew);
  EXPECT_EQ(store.apply(topicPiece(0, 3, 0)), Applied::kRejected);
  EXPECT_EQ(store.apply(topicPiece(1, 0, 0)), Applied::kNew);
  EXPECT_EQ(store.apply(topicPiece(2, 0, 0)), Applied::kRejected);
}

TEST(BeliefStoreTest, ARobotsDigestIsTheSumOfItsParts) {
  BeliefStore store;
  const Piece a = topicPiece(3, 0, 1), b = topicPiece(3, 1, 1);
  store.apply(a);
  store.apply(b);
  EXPECT_EQ(store.digestOf(world::RobotId{3}), contentHash(a) + contentHash(b));
  EXPECT_EQ(store.digestOf(world::RobotId{4}), 0u);
}

// The law of DESIGN §2.1: order, duplication and loss of what is repeated later cannot matter.
TEST(BeliefStoreTest, AnyOrderAndDuplicationGiveTheSameState) {
  Random random(20261122);
  std::vector<Piece> sent;
  for (int r = 0; r < 3; ++r)
    for (int t = 0; t < 3; ++t)
      for (int observation = 0; observation < 4; ++observation) {
        const int num_parts = 1 + (t + observation) % 3;
        for (int part = 0; part < num_parts; ++part)
          sent.push_back(topicPiece(r, t, observation, part, num_parts));
      }
  BeliefStore in_order;
  for (const Piece& piece : sent) in_order.apply(piece);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<Piece> shuffled = sent;
    for (int i = 0; i < 40; ++i) shuffled.push_back(sent[random.below(sent.size())]);
    for (size_t i = shuffled.size(); i > 1; --i) std::swap(shuffled[i - 1], shuffled[random.below(i)]);
    BeliefStore store;
    for (const Piece& piece : shuffled) store.apply(piece);
    ASSERT_EQ(held(store), held(in_order)) << "trial " << trial;
    ASSERT_EQ(store.digest(), in_order.digest()) << "trial " << trial;
  }
}

}  // namespace
}  // namespace shoal::mapping
