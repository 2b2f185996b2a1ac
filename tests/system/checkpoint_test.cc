// SPDX-License-Identifier: BSD-3-Clause
// Agents that save while they fly, in processes of their own so that they can be killed.
#include "robot_agent/checkpoint.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fusion_node/process.h"
#include "robot_agent/agent.h"
#include "shoal/comms/channels.h"
#include "shoal/comms/memory_bus.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/wire/heartbeat_codec.h"
#include "shoal/wire/message_kind.h"
#include "shoal/wire/piece_codec.h"
#include "shoal/world/place.h"

namespace shoal::robot_agent {
namespace {

constexpr int32_t kImages = 64, kMission = 7;

// Small pictures of a reef, rendered once.
const std::vector<world::Observation>& images() {
  static const std::vector<world::Observation> all = [] {
    const auto place = world::openPlace("reef:varied");
    world::SurveyOptions survey;
    survey.observations = kImages;
    survey.intrinsics = {128, 96, 80, 80, 63.5, 47.5};
    const auto source = place->source(survey, 0);
    std::vector<world::Observation> made;
    while (auto observation = source->next()) made.push_back(std::move(*observation));
    return made;
  }();
  return all;
}

struct Plan {
  int32_t from = 0;                 // image
  int32_t until = -1;               // image at which the signal comes; -1: after the last
  int signal = SIGINT;              // to the agent itself
  bool live = false;                // then it lands and lingers
  std::string checkpoint_dir = {};  // not where the map goes
  double rate = 0;
  int64_t later_us = 0;           // than the images' own times
  bool has_mission_time = false;  // as AgentOptions
};

class Images final : public world::ObservationSource {
 public:
  explicit Images(const Plan& plan) : plan_(plan), next_(plan.from) {}
  std::optional<world::Observation> next() override {
    if (next_ == plan_.until || (next_ == kImages && !plan_.live)) std::raise(plan_.signal);
    if (next_ == kImages) return std::nullopt;
    world::Observation seen = images()[static_cast<size_t>(next_++)];
    if (plan_.live) seen.number -= plan_.from;  // it counts anew
    seen.time.us += plan_.later_us;
    return seen;
  }
  std::optional<int32_t> numObservations() const override { return kImages; }

 private:
  const Plan plan_;
  int32_t next_;
};

// Calls back before anything is sent.
class WatchedBus final : public comms::Bus {
 public:
  WatchedBus(comms::Bus& bus, std::function<void(const comms::Packet&)> watch)
      : bus_(bus), watch_(std::move(watch)) {}
  void publish(const comms::Packet& packet) override {
    if (watch_) watch_(packet);
    bus_.publish(packet);
  }
  int receive(int timeout_ms, const std::function<void(const comms::Packet&)>& handler) override {
    return bus_.receive(timeout_ms, handler);
  }

 private:
  comms::Bus& bus_;
  std::function<void(const comms::Packet&)> watch_;
};

class CheckpointTest : public testing::Test {
 protected:
  CheckpointTest() { images(); }
  ~CheckpointTest() override { std::filesystem::remove_all(top_); }

  std::string path(const std::string& folder) const {
    return checkpointPath(top_ + "/" + folder, world::RobotId{0});
  }

  // One life in a process of its own, from the checkpoint in the folder if there is one.
  // @returns how it ended, as of waitpid().
  int fly(const std::string& folder, const Plan& plan,
          const std::function<void(const comms::Packet&)>& watch = {}) const {
    const pid_t child = ::fork();
    if (child == 0) {
      try {
        if (plan.rate != 0) ::alarm(60);  // ends who waits for what will not come
        fusion_node::setUpLog("R00", "off");
        fusion_node::catchStopSignals();
        AgentOptions options;
        options.explorer.keeps_pictures = true;
        options.mission = kMission;
        options.rate = plan.rate;
        options.live = plan.live;
        options.has_mission_time = plan.has_mission_time;
        options.out_dir = top_ + "/" + folder;
        options.checkpoint_dir = top_ + "/" + (plan.checkpoint_dir.empty() ? folder : plan.checkpoint_dir);
        options.resume = readCheckpoint(path(folder));
        if (options.resume) options.start_us = std::max<int64_t>(options.resume->mission_us, 1);
        comms::MemoryNetwork network;
        const auto bus = network.connect();
        WatchedBus watched(*bus, watch);
        Images source(plan);
        Agent(options, source, watched).run();
        ::_exit(0);
      } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        ::_exit(1);
      }
    }
    int status = 0;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    return status;
  }

  Checkpoint held(const std::string& folder) const {
    auto checkpoint = readCheckpoint(path(folder));
    EXPECT_TRUE(checkpoint.has_value());
    return checkpoint.value_or(Checkpoint{});
  }

  std::string text(const std::string& file) const { return mapping::readFile(top_ + "/" + file); }

  const std::string top_ = testing::TempDir() + "/checkpoint_test." + std::to_string(::getpid());
};

// All but the clocks and what had been sent by then, which depend on how long a life waited for its start.
void expectSame(const Checkpoint& a, const Checkpoint& b) {
  EXPECT_EQ(a.path.size(), b.path.size());
  EXPECT_TRUE(a.explorer == b.explorer);
  EXPECT_EQ(a.untold, b.untold);
  EXPECT_EQ(a.looked_until, b.looked_until);
  EXPECT_EQ(a.seen, b.seen);
  ASSERT_EQ(a.said.size(), b.said.size());
  for (size_t i = 0; i < a.said.size(); ++i) EXPECT_TRUE(a.said[i].piece == b.said[i].piece) << i;
}

TEST_F(CheckpointTest, GoingOnEqualsNeverHavingStopped) {
  ASSERT_EQ(fly("unbroken", {}), 0);
  EXPECT_EQ(held("unbroken").path.size(), size_t{kImages});
  EXPECT_GT(held("unbroken").said.size(), 100u);
  // Killed before the first save is done, right after one has begun, and on the way to the next.
  for (const int32_t at : {3, 25, 26, 40, 51})
    ASSERT_EQ(WTERMSIG(fly("killed", {.until = at, .signal = SIGKILL})), SIGKILL);
  EXPECT_LE(held("killed").path.size(), 50u);
  ASSERT_EQ(fly("killed", {}), 0);
  expectSame(held("killed"), held("unbroken"));
  for (const std::string file : {"/robots/R00/map.csv", "/robots/R00/topics.json"})
    EXPECT_EQ(text("killed" + file), text("unbroken" + file)) << file;
}

// A file stands where the checkpoints' folder should be: as on a full disk nothing can be saved.
TEST_F(CheckpointTest, WhatCannotBeSavedEndsNoFlight) {
  mapping::writeFileAtomically(top_ + "/in_the_way", "");
  ASSERT_EQ(fly("unsaved", {.until = 30, .checkpoint_dir = "in_the_way"}), 0);
  ASSERT_EQ(fly("unbroken", {.until = 30}), 0);
  EXPECT_EQ(text("unsaved/robots/R00/map.csv"), text("unbroken/robots/R00/map.csv"));
  ASSERT_EQ(fly("unsaved_live", {.until = 40, .live = true, .checkpoint_dir = "in_the_way"}), 0);
  EXPECT_TRUE(std::filesystem::exists(top_ + "/unsaved_live/robots/R00/map.csv"));
}

TEST_F(CheckpointTest, InFlightItIsOfABetweenImagesMoment) {
  ASSERT_EQ(WTERMSIG(fly("killed", {.until = 60, .signal = SIGKILL})), SIGKILL);
  const Checkpoint c = held("killed");
  EXPECT_EQ(c.path.size() % 25, 0u);
  EXPECT_EQ(c.mission, kMission);
  // Bricks whose turn has not come, and topics that have changed since theirs.
  if (!c.path.empty()) {
    EXPECT_FALSE(c.seen.empty());
    EXPECT_NE(
        std::ranges::find(c.untold, mapping::PieceKind::kTopic, [](const auto& w) { return w.key.kind; }),
        c.untold.end());
  }
}

TEST_F(CheckpointTest, CtrlCInTheMiddleLeavesAWholeOne) {
  for (const int32_t at : {1, 26, 33}) {
    const std::string folder = "stopped" + std::to_string(at);
    ASSERT_EQ(fly(folder, {.until = at}), 0);
    EXPECT_EQ(held(folder).path.size(), static_cast<size_t>(at) + 1);  // the image that was taken then
    EXPECT_TRUE(std::filesystem::exists(epochPath(top_ + "/" + folder, world::RobotId{0})));
    for (const auto& file : std::filesystem::directory_iterator(top_ + "/" + folder))
      EXPECT_EQ(file.path().string().find(".tmp"), std::string::npos) << file.path();
  }
  ASSERT_EQ(fly("stopped33", {}), 0);
  ASSERT_EQ(fly("unbroken", {}), 0);
  EXPECT_TRUE(held("stopped33").explorer == held("unbroken").explorer);
  EXPECT_EQ(text("stopped33/robots/R00/map.csv"), text("unbroken/robots/R00/map.csv"));
}

// A signal too ends it in good order, so that nobody thinks it lost.
TEST_F(CheckpointTest, WhoIsStoppedSaysThatItLeaves) {
  const auto watch = [&](const comms::Packet& packet) {
    const auto heartbeat = wire::decodeHeartbeat(packet.bytes);
    if (heartbeat && heartbeat->phase == wire::Phase::kLeaving)
      mapping::writeFileAtomically(top_ + "/left", std::to_string(heartbeat->observation));
  };
  ASSERT_EQ(fly("stopped", {.until = 26, .signal = SIGTERM}, watch), 0);
  ASSERT_TRUE(std::filesystem::exists(top_ + "/left"));
  EXPECT_EQ(text("left"), "26");  // of what it had learnt from
}

// What a live source has shown is gone: no word is said that its checkpoint does not have.
TEST_F(CheckpointTest, ALiveRobotSaysOnlyWhatIsSaved) {
  int said = 0;
  const auto watch = [&](const comms::Packet& packet) {
    const auto header = wire::peek(packet.bytes);
    if (!header || header->kind == wire::MessageKind::kHeartbeat ||
        header->kind == wire::MessageKind::kSettings)
      return;
    const auto pieces = wire::decodePieces(header->kind, packet.bytes);
    if (!pieces) return;
    const Checkpoint saved = *readCheckpoint(path("live"));
    for (const mapping::Piece& piece : *pieces) {
      const bool is_saved = std::ranges::any_of(saved.said, [&](const auto& s) { return s.piece == piece; });
      if (!is_saved) ::_exit(3);
      ++said;
    }
    if (said > 40) std::raise(SIGINT);
  };
  const int status = fly("live", {.live = true}, watch);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  const Checkpoint c = held("live");
  EXPECT_GE(c.path.size(), 5u);
  EXPECT_GT(c.said.size(), 40u);
}

// A team's mission began an hour ago by the clock of its cameras; one robot is started now, and once more.
TEST_F(CheckpointTest, ALiveRobotGoesByTheTimesOfItsCameras) {
  constexpr int64_t kHourUs = 3'600'000'000;
  int64_t latest_us = 0;
  const auto watch = [&latest_us](const comms::Packet& packet) {
    if (const auto heartbeat = wire::decodeHeartbeat(packet.bytes)) latest_us = heartbeat->time.us;
    if (latest_us >= 2 * kHourUs) ::_exit(4);
  };
  Plan plan{.until = 10, .live = true, .rate = 1, .later_us = kHourUs, .has_mission_time = true};
  ASSERT_EQ(fly("late", plan, watch), 0);  // and did not wait for an hour
  plan.from = 20;
  plan.until = 30;
  ASSERT_EQ(fly("late", plan, watch), 0);
  const Checkpoint c = held("late");
  ASSERT_EQ(c.path.size(), 22u);  // with each image that was taken at the signal
  const auto timeOf = [](size_t image) { return images()[image].time.us + kHourUs; };
  EXPECT_EQ(c.path[0].time.us, timeOf(0));
  EXPECT_EQ(c.path[11].time.us, timeOf(20));
  EXPECT_EQ(c.path[21].time.us, timeOf(30));
  EXPECT_GE(c.mission_us, timeOf(30));
  EXPECT_LT(c.mission_us, 2 * kHourUs);
}

TEST_F(CheckpointTest, AnEpochIsANumberAndNothingElse) {
  const std::string file = epochPath(top_, world::RobotId{0});
  EXPECT_FALSE(readEpoch(file).has_value());
  for (const auto& [text, epoch] : {std::pair("0\n", 0), {"7\n", 7}, {"41", 41}}) {
    mapping::writeFileAtomically(file, text);
    EXPECT_EQ(readEpoch(file), epoch);
  }
  for (const std::string text : {"", "\n", "x", "-1\n", "3 \n", "12a\n", "99999999999\n"}) {
    mapping::writeFileAtomically(file, text);
    try {
      readEpoch(file);
      ADD_FAILURE() << text;
    } catch (const std::runtime_error& error) {
      const std::string said = error.what();
      EXPECT_NE(said.find(file), std::string::npos) << said;
      EXPECT_NE(said.find('"' + text.substr(0, text.find('\n')) + '"'), std::string::npos) << said;
    }
  }
}

TEST_F(CheckpointTest, AnotherDetailIsRefusedByName) {
  ASSERT_EQ(fly("fine", {.until = 7}), 0);
  AgentOptions options;
  options.mission = kMission;
  options.explorer.keeps_pictures = true;
  options.explorer.detail = mapping::Detail::kCoarse;
  options.resume = held("fine");
  options.start_us = 1;
  comms::MemoryNetwork network;
  const auto bus = network.connect();
  Images source({});
  try {
    Agent(options, source, *bus);
    ADD_FAILURE();
  } catch (const std::invalid_argument& error) {
    const std::string said = error.what();
    EXPECT_NE(said.find("--detail coarse"), std::string::npos) << said;
    EXPECT_NE(said.find("detail fine"), std::string::npos) << said;
  }
}

TEST_F(CheckpointTest, WhatWasBegunByWhoWasKilledIsRemoved) {
  const std::string file = path("folder");
  mapping::writeFileAtomically(file, "whole");
  mapping::writeFileAtomically(file + ".tmp123", "half");
  mapping::writeFileAtomically(top_ + "/folder/R01.checkpoint.tmp9", "another's");
  removeUnfinished(file);
  EXPECT_TRUE(std::filesystem::exists(file));
  EXPECT_FALSE(std::filesystem::exists(file + ".tmp123"));
  EXPECT_TRUE(std::filesystem::exists(top_ + "/folder/R01.checkpoint.tmp9"));
  removeUnfinished(top_ + "/nowhere/R00.checkpoint");
}

}  // namespace
}  // namespace shoal::robot_agent
