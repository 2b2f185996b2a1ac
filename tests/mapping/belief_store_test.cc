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

// A brick of robot r with that many cells, whose key nobody else has.
Piece brickPiece(int r, int brick, int observation, int cells, int part = 0, int num_parts = 1) {
  BrickPart content;
  for (int i = 0; i < cells; ++i)
    content.cells.push_back({{16 * brick + i % 16, i / 16, part}, world::TopicId{0}, {observation}});
  return {{world::RobotId{r}, PieceKind::kBrick, {brick, 0, 0}}, {0, observation}, part, num_parts, content};
}

int64_t bytesOfAll(const BeliefStore& store) {
  int64_t bytes = kHeldBytesPerKey * static_cast<int64_t>(store.numPieces());
  store.visit([&](const Piece& piece) { bytes += heldBytes(piece); });
  return bytes;
}

TEST(BeliefStoreTest, BytesHeldAreThoseOfContentAndAFixedPartAPiece) {
  const int64_t empty = heldBytes({{}, {}, 0, 1, PicturePart{}});
  EXPECT_EQ(heldBytes(brickPiece(0, 0, 0, 10)), empty + 10 * 24);
  EXPECT_GE(24u, sizeof(BrickCell));
  EXPECT_EQ(heldBytes(topicPiece(0, 0, 0)), empty + 4 + 8);
  EXPECT_GE(empty, static_cast<int64_t>(sizeof(Piece)));
  BeliefStore store;
  store.apply(brickPiece(1, 0, 0, 10));
  store.apply(brickPiece(1, 0, 0, 10));
  EXPECT_EQ(store.numBytesOf(world::RobotId{1}), kHeldBytesPerKey + empty + 10 * 24);
  EXPECT_EQ(store.numBytes(), store.numBytesOf(world::RobotId{1}));
  EXPECT_EQ(store.numBytesOf(world::RobotId{2}), 0);
}

// Versions that supersede, parts that wait for ever, conflicts, new epochs: when nothing waits any more, what
// is counted is what is held.
TEST(BeliefStoreTest, BytesAreCountedExactlyWhateverComes) {
  Random random(6);
  for (int trial = 0; trial < 20; ++trial) {
    BeliefStore store;
    for (int i = 0; i < 400; ++i) {
      const int num_parts = 1 + static_cast<int>(random.below(3));
      Piece piece = brickPiece(static_cast<int>(random.below(3)), static_cast<int>(random.below(4)),
                               static_cast<int>(random.below(40)), 1 + static_cast<int>(random.below(30)),
                               static_cast<int>(random.below(static_cast<uint64_t>(num_parts))), num_parts);
      if (random.below(100) == 0) piece.version.epoch = 1;
      store.apply(piece);
      ASSERT_GE(store.numBytes(), bytesOfAll(store));  // what waits is counted too
    }
    for (int r = 0; r < 3; ++r)
      for (int brick = 0; brick < 4; ++brick) {
        Piece last = brickPiece(r, brick, 41, 3);
        last.version.epoch = 2;
        ASSERT_EQ(store.apply(last), Applied::kNew);
      }
    EXPECT_EQ(store.numBytes(), bytesOfAll(store));
    EXPECT_EQ(store.numBytes(), 12 * (kHeldBytesPerKey + heldBytes(brickPiece(0, 0, 0, 3))));
  }
}

TEST(BeliefStoreTest, ARobotThatIsFullMayStillReplaceWhatItSaidWithLess) {
  const int64_t one = kHeldBytesPerKey + heldBytes(brickPiece(0, 0, 0, 100));
  BeliefStore store({.max_bytes_per_robot = 2 * one});
  EXPECT_EQ(store.apply(brickPiece(0, 0, 0, 100)), Applied::kNew);
  EXPECT_EQ(store.apply(brickPiece(0, 1, 0, 100)), Applied::kNew);
  EXPECT_FALSE(store.isFull(world::RobotId{0}));
  EXPECT_EQ(store.apply(brickPiece(0, 2, 0, 1)), Applied::kRejected);
  EXPECT_EQ(store.apply(brickPiece(0, 1, 1, 101)), Applied::kRejected);
  EXPECT_TRUE(store.isFull(world::RobotId{0}));
  EXPECT_EQ(store.apply(brickPiece(0, 1, 0, 100)), Applied::kDuplicate);
  EXPECT_EQ(store.apply(brickPiece(0, 1, 2, 100)), Applied::kNew);
  EXPECT_EQ(store.numBytes(), 2 * one);
  EXPECT_EQ(store.apply(brickPiece(0, 1, 3, 1)), Applied::kNew);
  EXPECT_FALSE(store.isFull(world::RobotId{0}));
  EXPECT_EQ(store.apply(brickPiece(0, 2, 3, 1)), Applied::kNew);
  EXPECT_EQ(store.numPieces(), 3u);
  EXPECT_EQ(store.numBytes(), bytesOfAll(store));
}

// Some flood, with whatever wins them room: others have what is set aside for them, whenever they come.
TEST(BeliefStoreTest, NobodyPushesOutAnothersShare) {
  const StoreLimits limits{.max_robots = 4, .max_bytes = 80'000, .max_bytes_per_robot = 60'000};
  Random random(7);
  for (int trial = 0; trial < 50; ++trial) {
    BeliefStore store(limits);
    std::vector<Piece> modest;  // of robot 3, within an eighth
    int64_t bytes = 0;
    for (int brick = 0;; ++brick) {
      const Piece piece = brickPiece(3, brick, 0, 1 + static_cast<int>(random.below(40)));
      bytes += kHeldBytesPerKey + heldBytes(piece);
      if (bytes > limits.max_bytes / 2 / limits.max_robots) break;
      modest.push_back(piece);
    }
    size_t said = 0;
    int refused = 0;
    for (int i = 0; i < 2000; ++i) {
      const int part = static_cast<int>(random.below(3));
      const Piece flood =
          brickPiece(static_cast<int>(random.below(3)), static_cast<int>(random.below(60)),
                     static_cast<int>(random.below(50)), 1 + static_cast<int>(random.below(200)), part, 3);
      if (store.apply(flood) == Applied::kRejected) ++refused;
      ASSERT_LE(store.numBytes(), limits.max_bytes);
      for (int r = 0; r < 3; ++r) ASSERT_LE(store.numBytesOf(world::RobotId{r}), limits.max_bytes_per_robot);
      if (said < modest.size() && random.below(50) == 0) {
        ASSERT_EQ(store.apply(modest[said++]), Applied::kNew);
      }
    }
    EXPECT_GT(refused, 500);
    while (said < modest.size()) ASSERT_EQ(store.apply(modest[said++]), Applied::kNew);
    std::vector<Piece> kept;
    store.visitOf(world::RobotId{3}, [&](const Piece& piece) { kept.push_back(piece); });
    EXPECT_EQ(kept, modest);
  }
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
