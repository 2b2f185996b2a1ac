// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/mission_watch.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace shoal::console {
namespace {

constexpr int32_t kMission = 77;

comms::Packet packet(const std::string& node, const wire::Heartbeat& heartbeat) {
  return {"SHOAL_" + node + "_HEARTBEAT", wire::encode(heartbeat)};
}

wire::Heartbeat robot(uint64_t own_digest, wire::Phase phase = wire::Phase::kLanded) {
  wire::Heartbeat h;
  h.mission = kMission;
  h.time = {1'000'000};
  h.phase = phase;
  h.observation = 5;
  h.own_digest = own_digest;
  h.state_digest = own_digest;
  return h;
}

// OPERATOR as it is when it has heard and fused the two robots below.
wire::Heartbeat home() {
  wire::Heartbeat h;
  h.mission = kMission;
  h.time = {2'000'000};
  h.phase = wire::Phase::kNode;
  h.state_digest = 300;
  h.map_of_state = 300;
  h.map_digest = 9;
  h.roster = {{world::RobotId{0}, wire::shareDigest(100)}, {world::RobotId{1}, wire::shareDigest(200)}};
  return h;
}

class MissionWatchTest : public testing::Test {
 protected:
  void hear(const std::string& node, const wire::Heartbeat& heartbeat) {
    watch_.hear(packet(node, heartbeat));
  }
  void hearAll() {
    hear("R00", robot(100));
    hear("R01", robot(200));
    hear("OPERATOR", home());
  }
  MissionWatch watch_{kMission, 2, 1000};
};

using Lines = std::vector<std::string>;

TEST_F(MissionWatchTest, IsOverWhenAllHaveLandedAndTheOperatorHoldsAll) {
  hearAll();
  EXPECT_EQ(watch_.lacking(), Lines{});
  EXPECT_TRUE(watch_.allLanded());
  EXPECT_EQ(watch_.stateDigest(), 300u);
  EXPECT_EQ(watch_.mapDigest(), 9u);
  EXPECT_DOUBLE_EQ(watch_.missionTime(), 2.0);
}

TEST_F(MissionWatchTest, WaitsForThoseItHasNotHeard) {
  hear("R01", robot(200));
  EXPECT_EQ(watch_.unheard(), (Lines{"OPERATOR", "R00"}));
  EXPECT_EQ(watch_.lacking(), (Lines{"R00 was not heard", "OPERATOR was not heard"}));
  EXPECT_FALSE(watch_.allLanded());
}

TEST_F(MissionWatchTest, WaitsForARobotThatHasLandedAndWillLookAgain) {
  hearAll();
  wire::Heartbeat listening = robot(100, wire::Phase::kListening);
  listening.time = {3'000'000};
  hear("R00", listening);
  EXPECT_TRUE(watch_.allLanded());
  EXPECT_EQ(watch_.lacking(), Lines{"R00 has yet to look again at its map"});
}

TEST_F(MissionWatchTest, WaitsForARobotThatStillFlies) {
  hearAll();
  wire::Heartbeat flying = robot(100, wire::Phase::kFlying);
  flying.time = {3'000'000};
  hear("R00", flying);
  EXPECT_EQ(watch_.lacking(), Lines{"R00 has not landed"});
}

TEST_F(MissionWatchTest, WaitsUntilTheOperatorHoldsWhatARobotSaysItHas) {
  hearAll();
  wire::Heartbeat more = robot(201);
  more.time = {3'000'000};
  hear("R01", more);
  EXPECT_EQ(watch_.lacking(), Lines{"OPERATOR does not hold all of R01"});
  const auto statuses = watch_.statuses();
  ASSERT_EQ(statuses.size(), 3u);
  EXPECT_TRUE(statuses[0].heard_whole);
  EXPECT_FALSE(statuses[1].heard_whole);
}

TEST_F(MissionWatchTest, ARobotThatHasNothingToSayIsHeard) {
  hear("R00", robot(0));
  hear("R01", robot(200));
  hear("OPERATOR", home());
  EXPECT_EQ(watch_.lacking(), Lines{});
}

TEST_F(MissionWatchTest, WaitsUntilTheMapIsOfTheState) {
  hearAll();
  wire::Heartbeat behind = home();
  behind.time = {3'000'000};
  behind.map_of_state = 299;
  hear("OPERATOR", behind);
  EXPECT_EQ(watch_.lacking(), Lines{"OPERATOR has not fused what it holds"});
}

TEST_F(MissionWatchTest, WaitsUntilARobotThatFusesAgrees) {
  hearAll();
  wire::Heartbeat fusing = home();
  fusing.own_digest = 100;
  fusing.phase = wire::Phase::kLanded;
  fusing.state_digest = fusing.map_of_state = 299;
  hear("R00", fusing);
  EXPECT_EQ(watch_.lacking(), Lines{"R00 holds another state than OPERATOR"});
  fusing.time = {3'000'000};
  fusing.state_digest = fusing.map_of_state = 300;
  fusing.map_digest = 8;
  hear("R00", fusing);
  EXPECT_EQ(watch_.lacking(), Lines{"R00 made another map than OPERATOR from the same state"});
  fusing.time = {4'000'000};
  fusing.map_digest = 9;
  hear("R00", fusing);
  EXPECT_EQ(watch_.lacking(), Lines{});
}

TEST_F(MissionWatchTest, AnOldHeartbeatChangesNothing) {
  hearAll();
  wire::Heartbeat old = robot(99, wire::Phase::kFlying);
  old.time = {0};
  hear("R00", old);
  EXPECT_EQ(watch_.lacking(), Lines{});
}

TEST_F(MissionWatchTest, HearsAnotherMission) {
  EXPECT_FALSE(watch_.otherMission());
  wire::Heartbeat other = robot(1);
  other.mission = 78;
  hear("R05", other);
  EXPECT_EQ(watch_.otherMission(), 78);
  EXPECT_TRUE(watch_.nodes().empty());
}

TEST_F(MissionWatchTest, SurvivesRubbish) {
  comms::Packet rubbish = packet("R00", robot(100));
  for (size_t i = 0; i < rubbish.bytes.size(); ++i) {
    comms::Packet damaged = rubbish;
    damaged.bytes[i] ^= 0x40;
    watch_.hear(damaged);
    damaged.bytes.resize(i);
    watch_.hear(damaged);
  }
  EXPECT_TRUE(watch_.nodes().empty());
}

TEST_F(MissionWatchTest, ProgressChangesWithWhatIsKnownAndNotWithTime) {
  hearAll();
  const uint64_t before = watch_.progress();
  wire::Heartbeat again = home();
  again.time = {9'000'000};
  hear("OPERATOR", again);
  EXPECT_EQ(watch_.progress(), before);
  again.time = {10'000'000};
  again.state_digest = 301;
  hear("OPERATOR", again);
  EXPECT_NE(watch_.progress(), before);
}

// Two heartbeats in one second of mission time, more than the budget of 200 bytes a second.
TEST(MissionWatchBudgetTest, FindsTheWindowThatIsOverBudget) {
  MissionWatch watch(kMission, 2, 200);
  const comms::Packet sent = packet("R00", robot(1));
  watch.hear(packet("R01", robot(2)));
  watch.hear(sent);
  watch.hear(sent);
  const auto worst = watch.worstWindow();
  EXPECT_EQ(worst.node, "R00");
  EXPECT_EQ(worst.window.bytes, static_cast<int64_t>(2 * comms::wireSize(sent)));
  EXPECT_FALSE(worst.window.within_budget);
}

}  // namespace
}  // namespace shoal::console
