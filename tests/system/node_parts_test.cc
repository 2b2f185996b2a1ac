// SPDX-License-Identifier: BSD-3-Clause
// What fusion_node is made of, without a network: its state, and its query socket.
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <filesystem>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "fusion_node/mission_state.h"
#include "fusion_node/process.h"
#include "fusion_node/query_server.h"
#include "shoal/wire/piece_codec.h"

namespace shoal::fusion_node {
namespace {

using Json = nlohmann::ordered_json;

mapping::Piece topic(int robot, int64_t weight) {
  return {.key = {world::RobotId{robot}, mapping::PieceKind::kTopic, {0, 0, 0}},
          .version = {0, 3},
          .content = mapping::TopicPart{{0}, weight, {10}, {{2, 7}}}};
}

class MissionStateTest : public testing::Test {
 protected:
  void hear(const std::string& channel, const wire::Bytes& bytes) { state_.hear({channel, bytes}, stats_); }
  uint64_t refused(const std::string& reason) const {
    const auto found = stats_.rejected.find(reason);
    return found == stats_.rejected.end() ? 0 : found->second;
  }
  MissionState state_{5, {}};
  comms::Stats stats_;
};

TEST_F(MissionStateTest, TakesInWhatIsOfItsMission) {
  hear("SHOAL_R01_TOPICS", wire::encode(topic(1, 9), 5, {0}));
  EXPECT_NE(state_.beliefs().digestOf(world::RobotId{1}), 0u);
  EXPECT_TRUE(stats_.rejected.empty());
}

TEST_F(MissionStateTest, AnotherMissionStaysOutAndIsRemembered) {
  hear("SHOAL_R01_TOPICS", wire::encode(topic(1, 9), 6, {0}));
  EXPECT_EQ(state_.beliefs().numPieces(), 0u);
  EXPECT_EQ(state_.otherMissions(), std::set<int32_t>{6});
  EXPECT_EQ(refused("other mission"), 1u);
}

TEST_F(MissionStateTest, NobodySpeaksForAnother) {
  hear("SHOAL_R02_TOPICS", wire::encode(topic(1, 9), 5, {0}));
  EXPECT_EQ(state_.beliefs().numPieces(), 0u);
  EXPECT_EQ(refused("wrong sender"), 1u);
}

TEST_F(MissionStateTest, TwoProcessesWithOneIdAreAConflict) {
  hear("SHOAL_R01_TOPICS", wire::encode(topic(1, 9), 5, {0}));
  hear("SHOAL_R01_TOPICS", wire::encode(topic(1, 10), 5, {0}));
  EXPECT_EQ(state_.conflicts(), 1);
  EXPECT_EQ(refused("conflict"), 1u);
}

TEST_F(MissionStateTest, RubbishIsCountedByReason) {
  hear("SHOAL_R01_TOPICS", {1, 2, 3});
  hear("SOMEBODY_ELSE", wire::encode(topic(1, 9), 5, {0}));
  hear("SHOAL_R01_BRICK", wire::encode(topic(1, 9), 5, {0}));
  wire::Bytes torn = wire::encode(topic(1, 9), 5, {0});
  torn.pop_back();
  hear("SHOAL_R01_TOPICS", torn);
  EXPECT_EQ(state_.beliefs().numPieces(), 0u);
  uint64_t all = 0;
  for (const auto& [reason, count] : stats_.rejected) all += count;
  EXPECT_EQ(all, 4u);
}

TEST_F(MissionStateTest, AnOldHeartbeatDoesNotReplaceANewerOne) {
  wire::Heartbeat late, early;
  late.mission = early.mission = 5;
  late.time = {2'000'000};
  late.num_topics = 4;
  early.time = {1'000'000};
  hear("SHOAL_R01_HEARTBEAT", wire::encode(late));
  hear("SHOAL_R01_HEARTBEAT", wire::encode(early));
  EXPECT_EQ(state_.heartbeats().at("R01").num_topics, 4);
}

// The time of sending is stamped on; the message stays valid and the content the same.
TEST(StampTimeTest, ChangesTheTimeAndNothingElse) {
  wire::Bytes message = wire::encode(topic(1, 9), 5, {0});
  wire::stampTime(message, {123'456'789});
  EXPECT_EQ(message, wire::encode(topic(1, 9), 5, {123'456'789}));
}

class QueryServerTest : public testing::Test {
 protected:
  QueryServerTest() : dir_(testing::TempDir() + "shoal_q" + std::to_string(::getpid())) {}
  ~QueryServerTest() override { std::filesystem::remove_all(dir_); }
  static Json echo(const Json& question) { return {{"heard", question}}; }
  std::string dir_;
};

TEST_F(QueryServerTest, AnswersALineWithALine) {
  QueryServer server(dir_, echo);
  std::atomic<bool> done = false;
  Json answer;
  std::thread client([&] {
    answer = askNode(dir_, {{"query", "x"}});
    done = true;
  });
  while (!done) server.poll();
  client.join();
  EXPECT_EQ(answer, (Json{{"heard", {{"query", "x"}}}}));
}

TEST_F(QueryServerTest, NonsenseGetsAnErrorNotADeadServer) {
  QueryServer server(dir_, echo);
  const int fd = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, socketPath(dir_).c_str(), sizeof address.sun_path - 1);
  ASSERT_EQ(::connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  ASSERT_EQ(::send(fd, "][\n", 3, MSG_NOSIGNAL), 3);
  for (int i = 0; i < 10; ++i) server.poll();
  char buffer[256] = {};
  ASSERT_GT(::recv(fd, buffer, sizeof buffer - 1, 0), 0);
  EXPECT_TRUE(Json::parse(buffer).contains("error"));
  ::close(fd);
}

TEST_F(QueryServerTest, AQuestionThatCannotBeAnsweredGetsAnErrorNotADeadServer) {
  QueryServer server(dir_, [](const Json& question) -> Json { return {{"x", question.at("missing")}}; });
  std::atomic<bool> done = false;
  Json answer;
  std::thread client([&] {
    answer = askNode(dir_, {{"query", 5}});
    done = true;
  });
  while (!done) server.poll();
  client.join();
  EXPECT_TRUE(answer.contains("error"));
}

TEST_F(QueryServerTest, OneFolderOneNode) {
  QueryServer server(dir_, echo);
  EXPECT_THROW(QueryServer(dir_, echo), std::runtime_error);
}

TEST_F(QueryServerTest, ADeadNodesSocketIsTakenOver) {
  std::filesystem::create_directories(dir_);
  {
    const int fd = ::socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, socketPath(dir_).c_str(), sizeof address.sun_path - 1);
    ASSERT_EQ(::bind(fd, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    ::close(fd);  // without unlink, as a killed process leaves it
  }
  EXPECT_THROW(askNode(dir_, {{"query", "x"}}), std::runtime_error);
  EXPECT_NO_THROW(QueryServer(dir_, echo));
}

TEST(ProcessTest, MissionsAreNumbersOrNames) {
  EXPECT_EQ(missionId("7"), 7);
  EXPECT_GT(missionId("reef"), 0);
  EXPECT_EQ(missionId("reef"), missionId("reef"));
  EXPECT_NE(missionId("reef"), missionId("reef2"));
  EXPECT_GT(missionId("-3"), 0);
}

TEST(ProcessTest, RatesAreChecked) {
  EXPECT_EQ(parseRate("max"), 0.0);
  EXPECT_EQ(parseRate("10"), 10.0);
  for (const char* bad : {"", "0", "-1", "fast", "1x", "1e9"})
    EXPECT_THROW(parseRate(bad), std::invalid_argument) << bad;
}

}  // namespace
}  // namespace shoal::fusion_node
