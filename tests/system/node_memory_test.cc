// SPDX-License-Identifier: BSD-3-Clause
// What a node keeps of a mission, and that no kill takes back what it has acknowledged.
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <tuple>

#include <gtest/gtest.h>

#include "fusion_node/moment.h"
#include "fusion_node/node_memory.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/random.h"
#include "shoal/wire/piece_codec.h"

namespace shoal::fusion_node {
namespace {

constexpr int32_t kMission = 5;

comms::Packet topic(int32_t id) {
  const mapping::Piece piece{.key = {world::RobotId{1}, mapping::PieceKind::kTopic, {id, 0, 0}},
                             .version = {0, 3},
                             .content = mapping::TopicPart{{0}, 7, {10}, {{2, 7}}}};
  return {"SHOAL_R01_TOPICS", wire::encode(piece, kMission, {})};
}

comms::Packet heartbeat(int64_t second) {
  wire::Heartbeat h;
  h.mission = kMission;
  h.time = {second * 1'000'000};
  h.phase = wire::Phase::kNode;
  return {"SHOAL_OPERATOR_HEARTBEAT", wire::encode(h)};
}

class NodeMemoryTest : public testing::Test {
 protected:
  NodeMemoryTest() : dir_(testing::TempDir() + "shoal_m" + std::to_string(::getpid())) {}
  ~NodeMemoryTest() override { std::filesystem::remove_all(dir_); }

  void hear(NodeMemory& memory, MissionState& state, const comms::Packet& packet) {
    memory.keep(packet, state.hear(packet, stats_));
  }
  size_t held() {
    MissionState state(kMission, {});
    NodeMemory(dir_, "OPERATOR", kMission).recall(state);
    return state.beliefs().numPieces();
  }
  std::string dir_;
  comms::Stats stats_;
};

TEST_F(NodeMemoryTest, StateClockAndEventsComeBack) {
  const Moment began = thisMoment();
  MissionState before(kMission, {});
  {
    NodeMemory memory(dir_, "OPERATOR", kMission);
    EXPECT_FALSE(memory.recall(before));
    for (int i = 0; i < 20; ++i) hear(memory, before, topic(i % 10));
    hear(memory, before, heartbeat(1));
    hear(memory, before, heartbeat(2));  // too soon after the last to be kept
    hear(memory, before, heartbeat(40));
    memory.keepClock(40'000'000);
    memory.keepClock(41'999'999);  // too soon to be written
    before.passTime(100);          // it is lost
    hear(memory, before, topic(11));
    memory.commit(before);
  }
  MissionState after(kMission, {});
  NodeMemory memory(dir_, "OPERATOR", kMission);
  const auto clock = memory.recall(after);
  ASSERT_TRUE(clock);
  EXPECT_EQ(clock->mission_us, 40'000'000);
  EXPECT_EQ(clock->spoken_until_us, 42'000'000);
  EXPECT_EQ(clock->at.boot_id, thisMoment().boot_id);
  EXPECT_GE(clock->at.boot_us, began.boot_us);
  EXPECT_LE(clock->at.boot_us, thisMoment().boot_us);
  EXPECT_EQ(after.beliefs().digest(), before.beliefs().digest());
  ASSERT_EQ(after.events().size(), 2u);
  EXPECT_EQ(after.events()[1].kind, "lost");
  EXPECT_EQ(after.events(), before.events());
  size_t kept = 0;
  for (MissionFileReader file(missionFilePath(dir_, kMission)); file.next();) ++kept;
  EXPECT_EQ(kept, 13u);  // eleven topics, each once, and two heartbeats
}

TEST_F(NodeMemoryTest, WhoMayOnlyReadCanReadIt) {
  const std::string dir = dir_ + "/50% of #1?";
  {
    MissionState state(kMission, {});
    NodeMemory memory(dir, "OPERATOR", kMission);
    for (int i = 0; i < 3; ++i) hear(memory, state, topic(i));
    memory.commit(state);
  }
  const std::string file = missionFilePath(dir, kMission);
  std::filesystem::permissions(file, std::filesystem::perms{0444});
  std::filesystem::permissions(dir, std::filesystem::perms{0555});
  const bool is_root = ::geteuid() == 0;
  ASSERT_EQ(is_root ? ::seteuid(65534) : 0, 0);
  size_t kept = 0;
  std::string complaint;
  try {
    for (MissionFileReader reader(file); reader.next();) ++kept;
  } catch (const std::runtime_error& error) {
    complaint = error.what();
  }
  ASSERT_EQ(is_root ? ::seteuid(0) : 0, 0);
  std::filesystem::permissions(dir, std::filesystem::perms{0755});
  EXPECT_EQ(complaint, "");
  EXPECT_EQ(kept, 3u);
}

// As files of older builds, and those that somebody wrote into.
TEST_F(NodeMemoryTest, AClockThatWasMeddledWithIsNotBelieved) {
  const auto recalled = [&](const std::string& key, const std::string& value) {
    MissionState state(kMission, {});
    NodeMemory memory(dir_, "OPERATOR", kMission);
    memory.keepClock(1'000'000);
    MissionFile file(missionFilePath(dir_, kMission), "OPERATOR", kMission);
    file.set(key, value);
    file.commit();
    return memory.recall(state);
  };
  for (const std::string boot_us : {"", "soon", "12 "}) {
    const auto clock = recalled("boot_us", boot_us);
    ASSERT_TRUE(clock);
    EXPECT_EQ(clock->mission_us, 1'000'000);
    EXPECT_EQ(clock->at.boot_id, "") << boot_us;
    EXPECT_GT(clock->at.wall_us, 0);
  }
  for (const std::string mission_us : {"", "-1", "4611686018427387903", "99999999999999999999"})
    EXPECT_FALSE(recalled("mission_us", mission_us)) << mission_us;
  EXPECT_FALSE(recalled("wall_us", "noon"));
}

// Its own voice comes back to it by the link, and anybody can speak in its name.
TEST_F(NodeMemoryTest, WhatIsSaidInTheNodesNameMovesNoClock) {
  {
    MissionState state(kMission, {});
    NodeMemory memory(dir_, "OPERATOR", kMission);
    memory.keepClock(3'000'000);
    hear(memory, state, heartbeat(4'000'000'000'000));
    comms::Packet torn = heartbeat(50);
    torn.bytes.back() ^= 1;
    hear(memory, state, torn);
    hear(memory, state, heartbeat(4));  // its own are kept as before
    memory.commit(state);
  }
  MissionState state(kMission, {});
  NodeMemory memory(dir_, "OPERATOR", kMission);
  const auto clock = memory.recall(state);
  ASSERT_TRUE(clock);
  EXPECT_EQ(clock->mission_us, 3'000'000);
  size_t kept = 0;
  for (MissionFileReader file(missionFilePath(dir_, kMission)); file.next();) ++kept;
  EXPECT_EQ(kept, 2u);
}

TEST_F(NodeMemoryTest, ARobotThatHasLandedHasLandedStill) {
  const auto says = [](int64_t second, wire::Phase phase) {
    wire::Heartbeat h;
    h.mission = kMission;
    h.time = {second * 1'000'000};
    h.phase = phase;
    h.observation = static_cast<int32_t>(second);
    return comms::Packet{"SHOAL_R01_HEARTBEAT", wire::encode(h)};
  };
  {
    MissionState state(kMission, {});
    NodeMemory memory(dir_, "OPERATOR", kMission);
    hear(memory, state, says(1, wire::Phase::kFlying));
    hear(memory, state, says(2, wire::Phase::kFlying));
    hear(memory, state, says(3, wire::Phase::kLanded));  // soon after the last, and worth keeping
    hear(memory, state, says(4, wire::Phase::kLanded));
    memory.commit(state);
  }
  MissionState after(kMission, {});
  NodeMemory(dir_, "OPERATOR", kMission).recall(after);
  EXPECT_EQ(after.heartbeats().at("R01").phase, wire::Phase::kLanded);
  EXPECT_EQ(after.heartbeats().at("R01").observation, 3);
}

comms::Packet beatOf(const std::string& node, int64_t second, int32_t pid, int64_t bytes_sent) {
  wire::Heartbeat h;
  h.mission = kMission;
  h.time = {second * 1'000'000};
  h.pid = pid;
  h.bytes_sent = bytes_sent;
  h.class_bytes[0] = bytes_sent;
  return {"SHOAL_" + node + "_HEARTBEAT", wire::encode(h)};
}

// By hand: the first life had sent 300 bytes when it was last heard, the second 50.
TEST_F(NodeMemoryTest, WhatWasSentInLivesBeforeIsKnownStill) {
  {
    MissionState before(kMission, {});
    NodeMemory memory(dir_, "OPERATOR", kMission);
    for (const auto& [second, pid, bytes] : {std::tuple{1, 7, 100}, {3, 7, 300}, {2, 7, 200}, {4, 8, 50}})
      hear(memory, before, beatOf("R01", second, pid, bytes));
    memory.commit(before);
    EXPECT_EQ(before.overview().nodes.at(0).bytes_sent, 350);
    EXPECT_EQ(before.overview().nodes.at(0).class_bytes.at("heartbeat"), 350);
    EXPECT_EQ(before.heartbeats().at("R01").bytes_sent, 350);
  }
  MissionState after(kMission, {});
  NodeMemory memory(dir_, "OPERATOR", kMission);
  memory.recall(after);
  EXPECT_EQ(after.overview().nodes.at(0).bytes_sent, 350);
  hear(memory, after, beatOf("R01", 5, 8, 60));
  EXPECT_EQ(after.overview().nodes.at(0).bytes_sent, 360);
}

TEST_F(NodeMemoryTest, TheLastHeartbeatOfEverybodyIsKeptWhenTheNodeEnds) {
  {
    MissionState before(kMission, {});
    NodeMemory memory(dir_, "OPERATOR", kMission);
    for (const int64_t second : {1, 2, 3}) hear(memory, before, beatOf("R01", second, 7, 100 * second));
    hear(memory, before, beatOf("R02", 3, 7, 100));
    memory.keepLast();
    memory.commit(before);
  }
  MissionState after(kMission, {});
  NodeMemory(dir_, "OPERATOR", kMission).recall(after);
  EXPECT_EQ(after.heartbeats().at("R01").time.seconds(), 3);
  size_t kept = 0;
  for (MissionFileReader file(missionFilePath(dir_, kMission)); file.next();) ++kept;
  EXPECT_EQ(kept, 3u);
}

// Nothing is lost. The memory leaves out topics that were known and heartbeats between two of ten seconds.
TEST_F(NodeMemoryTest, LinksBeginAnewWithWhatIsHeardLive) {
  int64_t sent = 0, second = 0;
  const auto hearsASecond = [&](NodeMemory& memory, MissionState& state) {
    wire::Heartbeat h;
    h.mission = kMission;
    h.time = {++second * 1'000'000};
    h.bytes_sent = sent;
    for (const comms::Packet& packet : {comms::Packet{"SHOAL_R01_HEARTBEAT", wire::encode(h)}, topic(1)}) {
      hear(memory, state, packet);
      sent += static_cast<int64_t>(comms::wireSize(packet));
    }
    memory.commit(state);
  };
  {
    MissionState before(kMission, {});
    NodeMemory memory(dir_, "OPERATOR", kMission);
    for (int i = 0; i < 60; ++i) hearsASecond(memory, before);
    EXPECT_EQ(before.overview().nodes.at(0).heard_share, 1.0);
    EXPECT_EQ(before.missedOf("R01"), 0);
  }
  MissionState after(kMission, {});
  NodeMemory memory(dir_, "OPERATOR", kMission);
  memory.recall(after);
  EXPECT_FALSE(after.overview().nodes.at(0).heard_share);
  EXPECT_FALSE(after.missedOf("R01"));
  const int64_t unheard = sent;  // by this process
  for (int i = 0; i < 3; ++i) hearsASecond(memory, after);
  EXPECT_EQ(after.overview().nodes.at(0).heard_share, 1.0);
  EXPECT_EQ(after.missedOf("R01"), unheard);
}

TEST_F(NodeMemoryTest, EventsAreKeptOnceHoweverOftenItIsStartedAgain) {
  for (int life = 0; life < 3; ++life) {
    MissionState state(kMission, {});
    NodeMemory memory(dir_, "OPERATOR", kMission);
    memory.recall(state);
    hear(memory, state, heartbeat(1 + 20 * life));
    memory.commit(state);
    EXPECT_EQ(state.events().size(), 1u) << life;  // joined
  }
}

TEST_F(NodeMemoryTest, WhatWasNotCommittedIsGoneAndTheRestIsThere) {
  MissionState state(kMission, {});
  {
    NodeMemory memory(dir_, "OPERATOR", kMission);
    hear(memory, state, topic(1));
    memory.commit(state);
    hear(memory, state, topic(2));
  }
  EXPECT_EQ(held(), 1u);
}

TEST_F(NodeMemoryTest, OneFileAMission) {
  MissionState state(kMission, {});
  NodeMemory memory(dir_, "OPERATOR", kMission);
  hear(memory, state, topic(1));
  memory.commit(state);
  MissionState other(6, {});
  NodeMemory another(dir_, "OPERATOR", 6);
  another.recall(other);
  EXPECT_EQ(other.beliefs().numPieces(), 0u);
  EXPECT_THROW(MissionFile(missionFilePath(dir_, kMission), "OPERATOR", 6), std::runtime_error);
}

TEST_F(NodeMemoryTest, WhatIsNoSuchFileIsRefusedByName) {
  std::filesystem::create_directories(dir_);
  const std::string path = dir_ + "/mission-5.sqlite";
  for (const std::string& bytes : {std::string("nonsense, but long enough to be looked at as a file"),
                                   "SQLite format 3" + std::string(200, '\0')}) {
    mapping::writeFileAtomically(path, bytes);
    try {
      MissionFile(path, "OPERATOR", kMission);
      ADD_FAILURE() << "was taken";
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
    }
  }
}

// A child keeps topics and says through a pipe how many are safe; it is killed at a random moment, again and
// again on the same file.
TEST_F(NodeMemoryTest, KilledAtAnyMomentNothingAcknowledgedIsLost) {
  constexpr int kLives = 25, kMostBatches = 110;  // fewer than 10000 topics in all
  Random random(17);
  int32_t acknowledged = 0, killed_at_work = 0;
  for (int life = 0; life < kLives; ++life) {
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      ::close(ends[0]);
      MissionState state(kMission, {});
      NodeMemory memory(dir_, "OPERATOR", kMission);
      memory.recall(state);
      auto next = static_cast<int32_t>(state.beliefs().numPieces());
      for (const int32_t end = next + 3 * kMostBatches; next < end; next += 3) {
        for (int i = 0; i < 3; ++i) {
          const comms::Packet packet = topic(next + i);
          comms::Stats stats;
          memory.keep(packet, state.hear(packet, stats));
        }
        memory.commit(state);
        const int32_t safe = next + 3;
        if (::write(ends[1], &safe, sizeof safe) != sizeof safe) ::_exit(1);
      }
      while (true) ::pause();  // far ahead of who listens
    }
    ::close(ends[1]);
    // After so many acknowledgements more, and somewhat later.
    const int32_t until = acknowledged + 3 * static_cast<int32_t>(1 + random.below(40));
    int32_t safe = 0;
    while (safe < until && ::read(ends[0], &safe, sizeof safe) == sizeof safe) acknowledged = safe;
    ::usleep(static_cast<useconds_t>(random.below(2000)));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    killed_at_work += WIFSIGNALED(status) ? 1 : 0;
    while (::read(ends[0], &safe, sizeof safe) == sizeof safe) acknowledged = safe;
    ::close(ends[0]);
    const auto there = static_cast<int32_t>(held());
    ASSERT_GE(there, acknowledged) << "life " << life;
    ASSERT_EQ(there % 3, 0) << "a batch was torn in life " << life;
    acknowledged = there;
  }
  EXPECT_EQ(killed_at_work, kLives);
  EXPECT_GT(acknowledged, 3 * kLives);
}

}  // namespace
}  // namespace shoal::fusion_node
