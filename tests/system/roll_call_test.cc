// SPDX-License-Identifier: BSD-3-Clause
#include "robot_agent/roll_call.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "shoal/comms/channels.h"
#include "shoal/comms/stats.h"
#include "shoal/mapping/edit.h"
#include "shoal/mapping/piece.h"

namespace shoal::robot_agent {
namespace {

using wire::Phase;
using world::RobotId;
using Names = std::vector<std::string>;

constexpr int32_t kMission = 5;

class RollCallTest : public testing::Test {
 protected:
  // What a robot has learnt.
  static mapping::Piece pieceOf(int robot) {
    return mapping::pieceOf(RobotId{robot}, 0, {.words = 1, .hyperparameters = 2, .cell_size_m = 1});
  }
  static mapping::Piece topicOf(int robot, int topic) {
    return {{RobotId{robot}, mapping::PieceKind::kTopic, {topic, 0, 0}},
            {0, 7},
            0,
            1,
            mapping::TopicPart{{1}, 1, {10}, {{1, 1}}}};
  }
  static mapping::Piece brickOf(int robot) {
    return {{RobotId{robot}, mapping::PieceKind::kBrick, {0, 0, 0}},
            {0, 7},
            0,
            1,
            mapping::BrickPart{{{{0, 0, 0}, world::TopicId{1}, {10}}}}};
  }
  void tell(int robot) { heard_.apply(pieceOf(robot)); }
  void beat(int robot, Phase phase, int32_t budget = 2000) {
    beatWith({pieceOf(robot)}, robot, phase, budget);
  }
  void beatWith(const std::vector<mapping::Piece>& said, int robot, Phase phase, int32_t budget = 2000) {
    mapping::BeliefStore own;
    for (const mapping::Piece& piece : said) own.apply(piece);
    wire::Heartbeat h;
    h.time = {++time_};
    h.mission = kMission;
    h.phase = phase;
    h.own_digest = own.digestOf(RobotId{robot});
    if (wire::hasLanded(phase)) h.learnt = wire::shareDigest(own.learntDigestOf(RobotId{robot}));
    h.budget = budget;
    heard_.hear({comms::channelName(world::name(RobotId{robot}), "HEARTBEAT"), wire::encode(h)}, stats_);
  }
  Names missing(double wall_s) {
    call_.look(heard_, wall_s);
    return call_.missing(wall_s);
  }

  int64_t time_ = 0;
  comms::Stats stats_;
  fusion_node::MissionState heard_{kMission, {}};
  RollCall call_{RobotId{1}, 3, 100};  // R01 of R00, R01, R02
};

TEST_F(RollCallTest, WaitsForThoseThatFlyAndForAllThatTheyHadToSay) {
  EXPECT_EQ(missing(100), (Names{"R00", "R02"}));
  beat(0, Phase::kFlying);
  beat(2, Phase::kListening);
  tell(0);
  EXPECT_EQ(missing(101), (Names{"R00", "R02"}));  // one flies, of the other nothing is held
  tell(2);
  EXPECT_EQ(missing(101), Names{"R00"});
  beat(0, Phase::kListening);
  EXPECT_EQ(missing(102), Names{});
  EXPECT_TRUE(call_.silent(102).empty());
}

TEST_F(RollCallTest, TopicsAreWaitedForAndMapsAreNot) {
  tell(0);
  beat(0, Phase::kListening);
  tell(2);
  const std::vector<mapping::Piece> said{pieceOf(2), topicOf(2, 1), topicOf(2, 3), brickOf(2)};
  for (const mapping::Piece& topic : {topicOf(2, 1), topicOf(2, 3)}) {
    beatWith(said, 2, Phase::kListening);
    EXPECT_EQ(missing(101), Names{"R02"});
    heard_.apply(topic);
  }
  beatWith(said, 2, Phase::kFlying);
  EXPECT_EQ(missing(101), Names{"R02"});
  beatWith(said, 2, Phase::kListening);
  EXPECT_EQ(missing(101), Names{});
  EXPECT_FALSE(heard_.holdsWhole("R02"));
}

// Who has looked again has changed its map since, of which we may not hold all yet. What it has learnt we
// have.
TEST_F(RollCallTest, OnceIsEnough) {
  tell(0);
  tell(2);
  beat(0, Phase::kListening);
  beat(2, Phase::kLanded);
  EXPECT_EQ(missing(101), Names{});
  heard_.apply(topicOf(0, 1));
  beat(0, Phase::kLanded);
  EXPECT_EQ(missing(102), Names{});
}

TEST_F(RollCallTest, WaitsForWhomItMeets) {
  tell(0);
  tell(2);
  beat(0, Phase::kLanded);
  beat(2, Phase::kLanded);
  beat(7, Phase::kFlying);
  beat(1, Phase::kFlying);  // itself
  EXPECT_EQ(missing(101), Names{"R07"});
}

TEST_F(RollCallTest, WaitsNoMoreForWhoIsSilentUntilItIsHeardAgain) {
  beat(0, Phase::kFlying);
  EXPECT_EQ(missing(110), (Names{"R00", "R02"}));
  EXPECT_EQ(missing(115), Names{"R00"});  // never met: a quarter of a minute
  EXPECT_EQ(call_.silent(115), Names{"R02"});
  EXPECT_EQ(missing(169.9), Names{"R00"});
  EXPECT_EQ(missing(170), Names{});  // a minute
  EXPECT_EQ(call_.silent(170), (Names{"R00", "R02"}));
  beat(0, Phase::kFlying);
  EXPECT_EQ(missing(171), Names{"R00"});
}

TEST_F(RollCallTest, OnAThinBudgetPatienceIsLonger) {
  tell(2);
  beat(2, Phase::kLanded);
  beat(0, Phase::kFlying, 50);  // a heartbeat takes up to 50 s
  EXPECT_EQ(missing(100), Names{"R00"});
  EXPECT_EQ(missing(599), Names{"R00"});
  EXPECT_EQ(missing(601), Names{});
}

TEST_F(RollCallTest, ANewLifeHasToSayItAllAnew) {
  tell(0);
  tell(2);
  beat(0, Phase::kListening);
  beat(2, Phase::kListening);
  EXPECT_EQ(missing(101), Names{});
  wire::Heartbeat again;
  again.time = {++time_};
  again.mission = kMission;
  again.epoch = 1;
  again.own_digest = 1;
  heard_.hear({comms::channelName("R00", "HEARTBEAT"), wire::encode(again)}, stats_);
  EXPECT_EQ(missing(102), Names{"R00"});
}

TEST_F(RollCallTest, WhoIsExcludedIsNotWaitedFor) {
  tell(2);
  beat(2, Phase::kListening);
  beat(0, Phase::kFlying);
  heard_.apply(mapping::pieceOf({{"OPERATOR", 1}, {5}, mapping::ExcludeEdit{RobotId{0}}}));
  EXPECT_EQ(missing(101), Names{});
}

TEST(RollCallAloneTest, NobodyIsWaitedFor) {
  RollCall call(RobotId{0}, 1, 0);
  call.look(fusion_node::MissionState(kMission, {}), 0);
  EXPECT_TRUE(call.missing(0).empty());
}

}  // namespace
}  // namespace shoal::robot_agent
