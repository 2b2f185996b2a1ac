// SPDX-License-Identifier: BSD-3-Clause
// What replay and verify find in recordings made up by hand.
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fusion_node/mission_file.h"
#include "operator_console/agreement.h"
#include "operator_console/piece_audit.h"
#include "operator_console/recorded_mission.h"
#include "operator_console/replay.h"
#include "operator_console/traffic_audit.h"
#include "operator_console/verify.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/mapping/fusion.h"
#include "shoal/wire/piece_codec.h"

namespace shoal::console {
namespace {

using Lines = std::vector<std::string>;
constexpr int32_t kMission = 77;
constexpr int64_t kSecondUs = 1'000'000;
constexpr world::RobotId kRobot{0};

// One robot that says a topic, and a brick of three cells with their certainties; a node that hears it.
struct Mission {
  Mission() {
    topic = {{kRobot, mapping::PieceKind::kTopic, {4, 0, 0}},
             {0, 5},
             0,
             1,
             mapping::TopicPart{{0}, 10, {100}, {{1, 6}, {2, 4}}}};
    labels = {{kRobot, mapping::PieceKind::kBrick, {0, -1, 0}},
              {0, 5},
              0,
              1,
              mapping::BrickPart{{{{1, -2, 0}, world::TopicId{4}, {2 * kSecondUs}},
                                  {{2, -2, 0}, world::TopicId{4}, {3 * kSecondUs}},
                                  {{3, -2, 0}, world::TopicId{4}, {3 * kSecondUs}}}}};
    certainties = {{kRobot, mapping::PieceKind::kCertainty, {0, -1, 0}},
                   {0, 5},
                   0,
                   1,
                   mapping::CertaintyPart{{{{1, -2, 0}, 63}, {{2, -2, 0}, 21, 20}}}};
    for (const mapping::Piece* piece : {&topic, &labels, &certainties}) beliefs.apply(*piece);
    map = mapping::fuse(beliefs, {});

    robot.mission = node.mission = kMission;
    robot.phase = wire::Phase::kLanded;
    robot.observation = 5;
    robot.num_topics = 1;
    robot.num_cells = 3;
    robot.cell_size_m = node.cell_size_m = 0.5;
    robot.own_digest = robot.state_digest = beliefs.digestOf(kRobot);
    robot.pid = 11;
    robot.budget = 1000;
    node.phase = wire::Phase::kNode;
    node.state_digest = node.map_of_state = beliefs.digest();
    node.map_digest = map.digest();
    node.roster = {{kRobot, wire::shareDigest(robot.own_digest)}};
    node.pid = 12;
    node.budget = 1000;
  }

  void say(const mapping::Piece& piece, double at_s) {
    const std::string channel = "SHOAL_R00_" + std::string(wire::channelKind(wire::kindOf(piece)));
    packets.push_back({channel, wire::encode(piece, kMission, at(at_s))});
    robot.bytes_sent += static_cast<int64_t>(comms::wireSize(packets.back()));
  }
  void beat(const std::string& name, wire::Heartbeat& heartbeat, double at_s) {
    heartbeat.time = at(at_s);
    packets.push_back({"SHOAL_" + name + "_HEARTBEAT", wire::encode(heartbeat)});
    heartbeat.bytes_sent += static_cast<int64_t>(comms::wireSize(packets.back()));
  }
  void sayAll() {
    say(topic, 1);
    say(labels, 2);
    say(certainties, 3);
    beat("R00", robot, 10);
    beat("OPERATOR", node, 12);
  }

  // The recording as lcm-logger would write it.
  std::string write() const {
    const auto path = std::filesystem::temp_directory_path() / ("recording_test_" + std::to_string(getpid()));
    std::ofstream file(path, std::ios::binary);
    const auto put = [&file](uint64_t value, int bytes) {
      for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) file.put(static_cast<char>(value >> shift));
    };
    for (size_t i = 0; i < packets.size(); ++i) {
      const auto& [channel, bytes, trailer] = packets[i];
      put(0xEDA1DA01, 4), put(i, 8), put(i, 8), put(channel.size(), 4), put(bytes.size(), 4);
      file << channel;
      file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    }
    return path;
  }
  Verification verified() const { return verify(write()); }

  static world::Timestamp at(double seconds) { return {static_cast<int64_t>(seconds * 1e6)}; }

  mapping::Piece topic, labels, certainties;
  mapping::BeliefStore beliefs;
  mapping::GlobalMap map;
  wire::Heartbeat robot, node;
  std::vector<comms::Packet> packets;
};

TEST(VerifyTest, FindsNothingWrongWithAMissionInOrder) {
  Mission mission;
  mission.sayAll();
  mission.packets.push_back({"LCM_SELF_TEST", {1, 2, 3}});
  const Verification result = mission.verified();
  EXPECT_EQ(result.wrong(), Lines{});
  EXPECT_EQ(result.recorded.messages, 5);
  EXPECT_EQ(result.recorded.refused, 0);
  EXPECT_EQ(result.landed_s, 10.0);
  EXPECT_EQ(result.agreed_s, 12.0);
  ASSERT_EQ(result.traffic.size(), 2u);
  EXPECT_EQ(result.traffic[1].node, "R00");
  EXPECT_EQ(result.traffic[1].bytes, mission.robot.bytes_sent);
  EXPECT_EQ(result.traffic[1].datagrams, 4u);
  EXPECT_TRUE(result.json()["good"]);
  EXPECT_NE(result.text().find("agreement: 2.000 s after the last robot had landed at 10.000 s"),
            std::string::npos);
}

TEST(VerifyTest, NamesTheWindowThatIsOverBudget) {
  Mission mission;
  mission.robot.budget = 150;  // less than the three pieces and the heartbeat, all at once
  for (const auto* piece : {&mission.topic, &mission.labels, &mission.certainties}) mission.say(*piece, 10);
  mission.beat("R00", mission.robot, 10);
  mission.beat("OPERATOR", mission.node, 12);
  const Verification result = mission.verified();
  EXPECT_FALSE(result.budgetKept());
  EXPECT_EQ(result.wrong(), Lines{"R00 sent " + std::to_string(mission.robot.bytes_sent) +
                                  " bytes in 1.000 s from 10.000 s on, over its budget of 150 B/s"});
}

TEST(VerifyTest, SaysWhatTheRecordingLacksAndThatItWasNotSaidAgain) {
  Mission mission;
  mission.sayAll();
  mission.packets.erase(mission.packets.begin());  // the topic
  const Verification result = mission.verified();
  EXPECT_EQ(result.wrong(), Lines{"not in the recording: R00: 1 of 1 topics"});
  ASSERT_EQ(result.traffic[1].gaps.size(), 1u);
  EXPECT_EQ(result.traffic[1].gaps[0].until_s, 10);
  EXPECT_FALSE(result.json()["gaps_repaired"]);

  mission.say(mission.topic, 20);  // now it was
  const Verification repaired = mission.verified();
  EXPECT_EQ(repaired.wrong(), Lines{});
  EXPECT_EQ(repaired.traffic[1].gaps.size(), 1u);
  EXPECT_TRUE(repaired.json()["gaps_repaired"]);
}

TEST(VerifyTest, SaysWhoDisagreesAndWhoDoesNotBelong) {
  Mission mission;
  mission.sayAll();
  wire::Heartbeat other = mission.node;
  other.map_digest ^= 1;
  mission.beat("BASE", other, 13);
  wire::Heartbeat stranger = mission.robot;
  stranger.mission = kMission + 1;
  mission.beat("R05", stranger, 13);
  const Verification result = mission.verified();
  EXPECT_EQ(result.wrong(), (Lines{"OPERATOR made another map than BASE from the same state",
                                   "mission 78 is heard on the same URL"}));
  EXPECT_FALSE(result.agreed_s);
}

TEST(VerifyTest, AMissionThatNobodyEndedDidNotAgree) {
  Mission mission;
  mission.robot.phase = wire::Phase::kFlying;
  mission.sayAll();
  const Verification result = mission.verified();
  EXPECT_EQ(result.wrong(), Lines{"R00 has not landed"});
  EXPECT_NE(result.text().find("agreement: NONE"), std::string::npos);
}

TEST(VerifyTest, RefusesWhatIsNoRecording) {
  EXPECT_THROW(verify("no/such/log"), std::runtime_error);
  EXPECT_THROW(Mission().verified(), std::runtime_error);  // an empty file
}

TEST(ReplayTest, RebuildsTheTablesFromTheRecordingAlone) {
  Mission mission;
  mission.sayAll();
  const std::string out = testing::TempDir() + "recording_test_replay";
  std::filesystem::remove_all(out);
  const Replay result = replay(mission.write(), out, {});
  EXPECT_TRUE(result.isWhole());
  EXPECT_EQ(result.files, (Lines{"global_map.csv", "labels.csv", "surprise.csv", "global_map.png",
                                 "robots/R00/map.csv", "robots/R00/surprise.csv"}));
  EXPECT_EQ(mapping::readFile(out + "/robots/R00/surprise.csv"),
            "x_m,y_m,z_m,surprise\n"
            "1.000,-1.000,0.000,2.500\n");
  EXPECT_EQ(mapping::readFile(out + "/surprise.csv"),
            "x_m,y_m,z_m,label,robot,seen_s,surprise\n"
            "1.000,-1.000,0.000,4,R00,3.000,2.500\n");
  EXPECT_EQ(mapping::readFile(out + "/robots/R00/map.csv"),
            "x_m,y_m,z_m,topic,seen_s,certainty\n"
            "0.500,-1.000,0.000,4,2.000,1.0000\n"
            "1.000,-1.000,0.000,4,3.000,0.3333\n"
            "1.500,-1.000,0.000,4,3.000,0.0000\n");
  EXPECT_EQ(mapping::readFile(out + "/global_map.csv"),
            "x_m,y_m,z_m,label,robot,seen_s,certainty\n"
            "0.500,-1.000,0.000,4,R00,2.000,1.0000\n"
            "1.000,-1.000,0.000,4,R00,3.000,0.3333\n"
            "1.500,-1.000,0.000,4,R00,3.000,0.0000\n");
  EXPECT_EQ(mapping::readFile(out + "/global_map.png").substr(1, 3), "PNG");
  std::ofstream(out + "/summary.json") << "{}";
  EXPECT_THROW(replay(mission.write(), out, {}), std::invalid_argument);
}

// The same messages in a log, which holds all that was heard, and as what a node remembers, which does not.
TEST(RecordedMissionTest, AMemorySaysNothingOfLinks) {
  Mission mission;
  mission.sayAll();
  for (const double at_s : {13, 14}) mission.beat("R00", mission.robot, at_s);
  const std::string log = mission.write(), memory = log + ".sqlite";
  {
    fusion_node::MissionFile file(memory, "OPERATOR", kMission);
    for (const comms::Packet& packet : mission.packets) file.append(packet, 0);
    file.commit();
  }
  EXPECT_EQ(readRecording(log, {}).state.overview().nodes.at(0).heard_share, 1.0);
  EXPECT_FALSE(readRecording(memory, {}).state.overview().nodes.at(0).heard_share);
  std::filesystem::remove(memory);
}

TEST(ReplayTest, NamesWhatTheRecordingLacks) {
  Mission mission;
  mission.sayAll();
  mission.packets.erase(mission.packets.begin() + 1);  // the labels
  const std::string out = testing::TempDir() + "recording_test_lacking";
  const Replay result = replay(mission.write(), out, {});
  EXPECT_EQ(result.lacking, (Lines{"R00: labels of brick (0, -1, 0)", "R00: 3 of 3 cells"}));
  EXPECT_TRUE(std::filesystem::exists(out + "/global_map.csv"));
}

TEST(ReplayTest, AnotherMatchersMapIsNotTheMissions) {
  Mission mission;
  mission.node.map_digest ^= 1;
  mission.sayAll();
  const Replay result = replay(mission.write(), testing::TempDir() + "recording_test_matcher", {});
  ASSERT_EQ(result.lacking.size(), 1u);
  EXPECT_EQ(result.lacking[0].rfind("OPERATOR made another map of the same state: give the --matcher", 0),
            0u);
}

TEST(PieceAuditTest, NamesPartsAndCounterparts) {
  Mission mission;
  mission.topic.num_parts = 3;
  mission.topic.part = 1;
  PieceAudit audit;
  audit.hear(mission.topic);
  audit.hear(mission.certainties);
  EXPECT_EQ(audit.lacking(kRobot, mission.robot),
            (Lines{"R00: topic 4, part 1 of 3", "R00: topic 4, part 3 of 3",
                   "R00: labels of brick (0, -1, 0)", "R00: 1 of 1 topics", "R00: 3 of 3 cells"}));
  mission.topic.version = {0, 6};  // a newer version in one part: the old one's gaps no longer count
  mission.topic.num_parts = 1;
  mission.topic.part = 0;
  audit.hear(mission.topic);
  audit.hear(mission.labels);
  EXPECT_EQ(audit.lacking(kRobot, mission.robot), Lines{"R00: the newest version of some pieces"});
}

// Sent 100 B each; heartbeats say how many bytes went before them.
TEST(TrafficAuditTest, FindsGapsWhateverTheOrderOfTheRecording) {
  TrafficAudit audit;
  const comms::Packet packet{"SHOAL_R00_TOPICS", comms::Bytes(100 - 17 - 36)};
  ASSERT_EQ(comms::wireSize(packet), 100u);
  const auto say = [&](double at_s) {
    audit.hear("R00", {wire::MessageKind::kTopics, Mission::at(at_s), kMission}, packet, nullptr);
  };
  const auto beat = [&](double at_s, int64_t bytes_sent, int32_t pid) {
    wire::Heartbeat heartbeat;
    heartbeat.bytes_sent = bytes_sent;
    heartbeat.pid = pid;
    heartbeat.budget = 500;
    audit.hear("R00", {wire::MessageKind::kHeartbeat, Mission::at(at_s), kMission}, packet, &heartbeat);
  };
  beat(0, 0, 1);
  say(1);
  beat(2, 300, 1);  // 200 were recorded, but the third comes after it
  say(1.5);
  beat(4, 400, 1);  // nothing lacks
  beat(6, 700, 1);  // 500 were recorded: 200 lack, for good
  beat(8, 800, 1);
  beat(0, 50, 2);  // another process in its place; 50 lack before its first word
  const std::vector<NodeTraffic> traffic = audit.traffic();
  ASSERT_EQ(traffic.size(), 2u);
  EXPECT_EQ(traffic[0].bytes, 700);
  EXPECT_EQ(traffic[0].budget, 500);
  ASSERT_EQ(traffic[0].gaps.size(), 1u);
  EXPECT_EQ(traffic[0].gaps[0].from_s, 4);
  EXPECT_EQ(traffic[0].gaps[0].until_s, 6);
  EXPECT_EQ(traffic[0].gaps[0].bytes, 200);
  EXPECT_EQ(traffic[1].pid, 2);
  ASSERT_EQ(traffic[1].gaps.size(), 1u);
  EXPECT_EQ(traffic[1].gaps[0].bytes, 50);
}

// Budget 150 B/s, 100 B each: two within a second are too many, whoever says the second.
TEST(TrafficAuditTest, WhoTakesTheirPlaceHasTheirBudget) {
  const auto isWithin = [](double later_s, int32_t later_budget) {
    TrafficAudit audit;
    const auto beat = [&](double at_s, int32_t pid, int32_t budget) {
      wire::Heartbeat heartbeat;
      heartbeat.pid = pid;
      heartbeat.budget = budget;
      audit.hear("R00", {wire::MessageKind::kHeartbeat, Mission::at(at_s), kMission},
                 {"SHOAL_R00_TOPICS", comms::Bytes(100 - 17 - 36)}, &heartbeat);
    };
    beat(0, 1, 150);
    beat(2, 1, 150);
    beat(later_s, 2, later_budget);
    const std::vector<NodeTraffic> traffic = audit.traffic();
    EXPECT_EQ(traffic.size(), 2u);
    EXPECT_TRUE(traffic[0].worst.within_budget);
    return traffic[1].worst.within_budget;
  };
  EXPECT_FALSE(isWithin(2.5, 150));
  EXPECT_TRUE(isWithin(3.5, 150));
  EXPECT_TRUE(isWithin(2.5, 140));  // started with another budget
  EXPECT_TRUE(isWithin(1.5, 150));  // its clock began anew
}

TEST(TrafficAuditTest, WholeMapsAreNotOnTheLink) {
  TrafficAudit audit;
  audit.hear("OPERATOR", {wire::MessageKind::kMap, {0}, kMission}, {"SHOAL_OPERATOR_MAP", {1}}, nullptr);
  EXPECT_TRUE(audit.traffic().empty());
}

TEST(AgreementTest, CountsFromTheLastLandingToTheLastDisagreement) {
  Mission mission;
  std::map<std::string, wire::Heartbeat> nodes;
  Agreement agreement;
  const auto hear = [&](const std::string& name, const wire::Heartbeat& heartbeat, double at_s) {
    nodes[name] = heartbeat;
    nodes[name].time = Mission::at(at_s);
    agreement.update(nodes);
  };
  wire::Heartbeat flying = mission.robot;
  flying.phase = wire::Phase::kFlying;
  hear("R00", flying, 1);
  hear("OPERATOR", mission.node, 2);
  EXPECT_FALSE(agreement.landedAt());
  hear("R00", mission.robot, 5);
  EXPECT_EQ(agreement.landedAt(), 5.0);
  EXPECT_EQ(agreement.agreedAt(), 5.0);
  wire::Heartbeat behind = mission.node;
  behind.roster.clear();
  hear("BASE", behind, 6);  // one more that fuses, and has not heard
  EXPECT_FALSE(agreement.agreedAt());
  EXPECT_EQ(disagreements(nodes), Lines{"BASE does not hold all of R00"});
  hear("BASE", mission.node, 9);
  EXPECT_EQ(agreement.landedAt(), 5.0);
  EXPECT_EQ(agreement.agreedAt(), 9.0);
}

TEST(AgreementTest, NamesEveryReason) {
  Mission mission;
  EXPECT_EQ(disagreements({}), (Lines{"no robot was heard", "no node that fuses was heard"}));
  wire::Heartbeat fusing = mission.robot;  // a robot that fuses, and holds other things
  fusing.state_digest = 5;
  fusing.map_of_state = 4;
  fusing.roster = mission.node.roster;
  EXPECT_EQ(disagreements({{"OPERATOR", mission.node}, {"R00", fusing}}),
            (Lines{"R00 has not fused what it holds", "R00 holds another state than OPERATOR"}));
}

}  // namespace
}  // namespace shoal::console
