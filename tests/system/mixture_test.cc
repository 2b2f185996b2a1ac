// SPDX-License-Identifier: BSD-3-Clause
// What does not belong together is told and kept apart: a node on a memory bus, and robots that are made up.
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fusion_node/node.h"
#include "shoal/comms/channels.h"
#include "shoal/comms/memory_bus.h"
#include "shoal/mapping/belief_pieces.h"
#include "shoal/mapping/fusion.h"
#include "shoal/wire/heartbeat_codec.h"
#include "shoal/wire/message_kind.h"
#include "shoal/wire/piece_codec.h"

namespace shoal::fusion_node {
namespace {

constexpr int32_t kMission = 7;
constexpr int64_t kSecondUs = 1'000'000;
constexpr mapping::SettingsPart kUsual{11, 22, 1.0};

class MixtureTest : public testing::Test {
 protected:
  void say(const std::string& robot, int64_t time_s, int32_t pid = 1, int32_t mission = kMission) {
    wire::Heartbeat h;
    h.time = {time_s * kSecondUs};
    h.mission = mission;
    h.observation = 1;
    h.pid = pid;
    const std::string channel = comms::channelName(robot, "HEARTBEAT");
    air_->publish({channel, wire::encode(h)});
    node_.turn(0);
  }

  void say(const mapping::Piece& piece) {
    const bool is_edit = piece.key.robot == mapping::kOperators;
    const std::string channel =
        comms::channelName(is_edit ? "SHORE" : name(piece.key.robot), wire::channelKind(wire::kindOf(piece)));
    air_->publish({channel, wire::encode(piece, kMission, {})});
    node_.turn(0);
  }

  // A robot that saw what all see, ten cells of it.
  void flies(int robot, const mapping::SettingsPart& settings) {
    say(mapping::pieceOf(world::RobotId{robot}, 0, settings));
    beliefOf(robot);
  }
  void beliefOf(int robot) {
    mapping::LocalBelief belief{world::RobotId{robot}, {0, 1}, {{"a", 0, 100}}, {}, {}};
    mapping::BelievedTopic topic{world::TopicId{0}, {kSecondUs}, 0, {}};
    for (int word = 0; word < 50; ++word) topic.words.push_back({word, 10 + word});
    for (const auto& word : topic.words) topic.weight += word.count;
    belief.topics.push_back(topic);
    for (int x = 0; x < 10; ++x)
      belief.cells.push_back({{x, 5 * robot, 0}, world::TopicId{0}, {(10 + x) * kSecondUs}, 0.5f});
    mapping::BeliefChanges changes;
    for (const mapping::Piece& piece : changes.update(belief)) say(piece);
  }

  std::vector<std::string> kinds() const {
    std::vector<std::string> kinds;
    for (const mapping::Mixture& m : node_.state().mixtures()) kinds.push_back(m.kind + " " + m.node);
    return kinds;
  }
  mapping::GlobalMap map() const { return mapping::fuse(node_.state().beliefs(), {}); }
  int labelOf(int robot) const {
    for (const mapping::Correspondence& c : map().correspondences)
      if (c.robot == world::RobotId{robot}) return number(c.label);
    return -1;
  }

  static NodeOptions options() {
    NodeOptions options;
    options.mission = kMission;
    return options;
  }

  comms::MemoryNetwork network_;
  std::unique_ptr<comms::MemoryBus> air_ = network_.connect(), ears_ = network_.connect(),
                                    local_ = network_.connect();
  Node node_{options(), *ears_, *local_};
};

using Kinds = std::vector<std::string>;

TEST_F(MixtureTest, AClockAnHourOffIsToldWithHowMuch) {
  for (int second = 0; second < 20; ++second) {
    for (const char* robot : {"R00", "R01", "R02"}) say(robot, second);
    say("R03", second + 3600);
  }
  EXPECT_EQ(kinds(), (Kinds{"clock R03"}));
  const mapping::MissionView view = node_.state().view();
  EXPECT_NEAR(view.nodes.at(3).clock_skew_s.value(), 3600, 1.5);
  EXPECT_NEAR(view.nodes.at(1).clock_skew_s.value(), 0, 1.5);
  ASSERT_EQ(view.mixed.size(), 1u);
  EXPECT_NE(view.mixed[0].says.find("ahead of"), std::string::npos);
}

TEST_F(MixtureTest, ClocksThatAgreeAreNotAlarmedWhoeverIsSilent) {
  for (int second = 0; second < 4000; second += 5) {
    say("R00", second);
    if (second % 60 == 0) say("R01", second);               // a thin budget
    if (second < 100 || second > 3700) say("R02", second);  // out of range for an hour
    if (second < 200) say("R03", second);                   // lost
  }
  EXPECT_EQ(kinds(), Kinds{});
  for (const mapping::NodeStatus& n : node_.state().view().nodes) {
    if (n.phase == "node") continue;
    EXPECT_NEAR(n.clock_skew_s.value(), 0, 5) << n.name;
  }
}

TEST_F(MixtureTest, ARobotBehindIsToldAndAlsoOfTwo) {
  for (int second = 4000; second < 4010; ++second) {
    say("R00", second);
    say("R01", second - 3600);
  }
  EXPECT_EQ(kinds(), (Kinds{"clock R00", "clock R01"}));  // which of two is wrong, nobody can tell
  EXPECT_NEAR(node_.state().view().nodes.at(1).clock_skew_s.value(), -3600, 1.5);
}

TEST_F(MixtureTest, TwoProcessesByOneNameAreTold) {
  for (int second = 0; second < 6; ++second) {
    say("R00", second, 100);
    say("R00", second, 200);
  }
  EXPECT_EQ(kinds(), (Kinds{"twin R00"}));
}

TEST_F(MixtureTest, TwinsAreToldWhicheverClockIsAhead) {
  say("R00", 10, 100);
  for (int second = 1000; second < 1200; second += 10) {
    say("R00", second, 200);
    say("R00", second - 980, 100);
  }
  EXPECT_EQ(kinds(), (Kinds{"twin R00"}));
}

TEST_F(MixtureTest, ARestartIsNoTwinEvenWhenOldWordsComeLate) {
  for (int second = 0; second < 10; ++second) say("R00", second, 100);
  say("R00", 16, 200);
  for (const int late : {10, 11, 12, 13}) {  // sent before the other began
    say("R00", late, 100);
    say("R00", 17 + late, 200);
  }
  EXPECT_EQ(kinds(), Kinds{});
}

TEST_F(MixtureTest, TwoMissionsOnOneUrlAreToldAndTheOtherDoesNotEnter) {
  say("R00", 1);
  say("R01", 1, 1, kMission + 1);
  EXPECT_EQ(kinds(), (Kinds{"mission "}));
  EXPECT_FALSE(node_.state().heartbeats().contains("R01"));
  EXPECT_NE(node_.state().mixtures()[0].says.find(std::to_string(kMission + 1)), std::string::npos);
}

TEST_F(MixtureTest, TopicsOfOtherSettingsAreNeverMatched) {
  flies(0, kUsual);
  flies(1, kUsual);
  flies(2, {kUsual.words, 23, kUsual.cell_size_m});
  flies(3, {12, kUsual.hyperparameters, kUsual.cell_size_m});
  EXPECT_EQ(kinds(), (Kinds{"settings R02", "settings R03"}));
  EXPECT_EQ(labelOf(0), labelOf(1));
  EXPECT_EQ(labelOf(2), 20000);
  EXPECT_EQ(labelOf(3), 30000);
  EXPECT_EQ(map().cells.size(), 40u);
}

TEST_F(MixtureTest, CellsOfAnotherSizeAreLeftOutOfTheMap) {
  flies(0, {kUsual.words, kUsual.hyperparameters, 0.5});
  EXPECT_EQ(map().cells.size(), 10u);
  flies(1, kUsual);
  EXPECT_EQ(node_.state().cellSize(), 0.5);  // one against one: the lower robot's
  flies(2, kUsual);
  EXPECT_EQ(node_.state().cellSize(), 1.0);
  EXPECT_EQ(kinds(), (Kinds{"settings R00"}));
  EXPECT_EQ(map().cells.size(), 20u);
}

// Its topics wait for its settings; where nobody has told any, as in old recordings, all are alike.
TEST_F(MixtureTest, WhoHasNotToldItsSettingsWaits) {
  beliefOf(0);
  beliefOf(1);
  EXPECT_EQ(labelOf(0), labelOf(1));
  say(mapping::pieceOf(world::RobotId{0}, 0, kUsual));
  EXPECT_NE(labelOf(0), labelOf(1));
  EXPECT_EQ(kinds(), Kinds{});
  say(mapping::pieceOf(world::RobotId{1}, 0, kUsual));
  EXPECT_EQ(labelOf(0), labelOf(1));
}

// A robot that began anew has lost its disk, and the first it says is a heartbeat.
TEST_F(MixtureTest, AHeartbeatOfANewEpochVoidsWhatWasSaidBefore) {
  flies(0, kUsual);
  flies(1, kUsual);
  EXPECT_EQ(map().cells.size(), 20u);
  wire::Heartbeat h;
  h.mission = kMission;
  h.epoch = 1;
  air_->publish({comms::channelName("R00", "HEARTBEAT"), wire::encode(h)});
  node_.turn(0);
  EXPECT_EQ(map().cells.size(), 10u);
  EXPECT_EQ(node_.state().beliefs().digestOf(world::RobotId{0}), 0u);
  flies(0, kUsual);  // of before, said again by who has not heard it yet
  EXPECT_EQ(map().cells.size(), 10u);
}

// What an operator excluded has no say in what is usual; a map that grew is the map made at once.
TEST_F(MixtureTest, TheExcludedDoNotCountAndTheMapIsAFunctionOfTheState) {
  mapping::FusedMap grown;
  const auto check = [&] {
    grown.update(node_.state().beliefs(), {});
    EXPECT_EQ(grown.digest(), map().digest());
    EXPECT_EQ(grown.map().cells, map().cells);
  };
  flies(2, {kUsual.words, kUsual.hyperparameters, 0.5});
  check();
  flies(3, {kUsual.words, kUsual.hyperparameters, 0.5});
  flies(1, kUsual);
  check();
  EXPECT_EQ(map().cells.size(), 20u);
  say(mapping::pieceOf({{"OPERATOR", 1}, {kSecondUs}, mapping::ExcludeEdit{world::RobotId{2}}}));
  check();
  EXPECT_EQ(map().cells.size(), 10u);  // one each: that of the lower robot
  EXPECT_EQ(map().cells[0].robot, world::RobotId{1});
}

}  // namespace
}  // namespace shoal::fusion_node
