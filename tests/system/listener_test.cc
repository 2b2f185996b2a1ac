// SPDX-License-Identifier: BSD-3-Clause
// Whether all that a robot had to say is held, as the heartbeats of nodes that fuse say.
#include "robot_agent/listener.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "robot_agent/voice.h"
#include "shoal/comms/channels.h"
#include "shoal/comms/memory_bus.h"
#include "shoal/mapping/piece.h"
#include "shoal/wire/heartbeat_codec.h"
#include "shoal/wire/piece_codec.h"

namespace shoal::robot_agent {
namespace {

using wire::Phase;

constexpr int32_t kMission = 3;
constexpr int64_t kSecondUs = 1'000'000;
constexpr world::RobotId kRobot{4};

class ListenerTest : public testing::Test {
 protected:
  ListenerTest() {
    const mapping::Piece piece =
        mapping::pieceOf(kRobot, 0, {.words = 1, .hyperparameters = 2, .cell_size_m = 1});
    voice_.say(piece, wire::encode(piece, kMission, {}));
  }

  void pass(int64_t seconds) { clock_.advanceTo(clock_.now() + seconds * kSecondUs); }

  // A node that fuses, and what it holds of the robot.
  void beat(const std::string& node, bool holds, Phase phase = Phase::kNode, int32_t budget = 0) {
    wire::Heartbeat h;
    h.time = {clock_.now()};
    h.mission = kMission;
    h.phase = phase;
    h.map_of_state = 9;
    h.budget = budget;
    const uint32_t mine = wire::shareDigest(voice_.said().digestOf(kRobot));
    h.roster = {{kRobot, holds ? mine : mine + 1}};
    others_->publish({comms::channelName(node, "HEARTBEAT"), wire::encode(h)});
    listener_->hear(0);
  }

  std::unique_ptr<Listener> listener(bool fuses) {
    return std::make_unique<Listener>(ListenerOptions{.robot = kRobot, .mission = kMission, .fuses = fuses},
                                      *bus_, clock_, state_, voice_);
  }

  comms::MemoryNetwork network_;
  const std::unique_ptr<comms::MemoryBus> bus_ = network_.connect(), others_ = network_.connect();
  comms::MissionClock clock_{0};
  fusion_node::MissionState state_{kMission, {}};
  Voice voice_{{.robot = kRobot, .mission = kMission}, *bus_, state_};
  std::unique_ptr<Listener> listener_ = listener(false);
};

TEST_F(ListenerTest, AllThatAreHeardHaveToHoldIt) {
  EXPECT_FALSE(listener_->isHeard());
  beat("OPERATOR", true);
  EXPECT_TRUE(listener_->isHeard());
  beat("BOAT", false);
  EXPECT_FALSE(listener_->isHeard());
  beat("BOAT", true);
  EXPECT_TRUE(listener_->isHeard());
}

TEST_F(ListenerTest, WhoLeavesIsNotWaitedFor) {
  beat("BOAT", false, Phase::kLeaving);
  EXPECT_FALSE(listener_->isHeard());  // nobody has it
  beat("OPERATOR", true);
  EXPECT_TRUE(listener_->isHeard());
  beat("BOAT", false);  // it is back
  EXPECT_FALSE(listener_->isHeard());
}

TEST_F(ListenerTest, WhoIsSilentForLongIsNotWaitedFor) {
  beat("BOAT", false);
  beat("SLOW", false, Phase::kNode, 50);  // under a thin budget a heartbeat comes seldom
  pass(55);
  beat("OPERATOR", true);
  EXPECT_FALSE(listener_->isHeard());
  pass(10);
  EXPECT_FALSE(listener_->isHeard());
  pass(60);
  beat("OPERATOR", true);
  beat("SLOW", true, Phase::kNode, 50);
  EXPECT_TRUE(listener_->isHeard());
  pass(1000);  // it held it, whatever became of it
  EXPECT_TRUE(listener_->isHeard());
  beat("BOAT", false);
  EXPECT_FALSE(listener_->isHeard());
}

// Two robots that fuse, and no other node: whoever ends first must not keep the other waiting for ever.
TEST_F(ListenerTest, TheLastThatFusesIsDoneWhenTheOthersHaveLeft) {
  listener_ = listener(true);
  EXPECT_FALSE(listener_->isHeard());
  beat("R01", false, Phase::kLanded);
  EXPECT_FALSE(listener_->isHeard());
  beat("R01", false, Phase::kLeaving);
  EXPECT_TRUE(listener_->isHeard());
  beat("OPERATOR", false);
  EXPECT_FALSE(listener_->isHeard());
  pass(100);  // out of reach, perhaps
  EXPECT_FALSE(listener_->isHeard());
}

}  // namespace
}  // namespace shoal::robot_agent
