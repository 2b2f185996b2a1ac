// SPDX-License-Identifier: BSD-3-Clause
// A fusion node on buses of memory: what it says, and when.
#include "fusion_node/node.h"

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include "shoal/comms/memory_bus.h"
#include "shoal/comms/window_meter.h"
#include "shoal/wire/map_codec.h"
#include "shoal/wire/piece_codec.h"

namespace shoal::fusion_node {
namespace {

constexpr int32_t kMission = 7;

class NodeTest : public testing::Test {
 protected:
  static NodeOptions options() {
    NodeOptions options;
    options.mission = kMission;
    options.rate = 0;
    return options;
  }

  comms::MemoryNetwork network_, here_;
  std::unique_ptr<comms::MemoryBus> air_ = network_.connect(), ears_ = network_.connect();
  std::unique_ptr<comms::MemoryBus> listener_ = here_.connect(), local_ = here_.connect();
};

// One brick a chunk. Between two turns the node listens and answers.
TEST_F(NodeTest, SaysAFewChunksOfItsMapATurnAndAllInTheEnd) {
  constexpr int kBricks = 100;
  NodeOptions unlimited = options();
  unlimited.budget = 0;
  Node node(unlimited, *ears_, *local_);
  for (int x = 0; x < kBricks; ++x) {
    const mapping::Piece brick{
        .key = {world::RobotId{1}, mapping::PieceKind::kBrick, {x, 0, 0}},
        .version = {0, 1},
        .content = mapping::BrickPart{{{{16 * x, 0, 0}, world::TopicId{0}, {1'000'000}}}}};
    air_->publish({"SHOAL_R01_BRICK", wire::encode(brick, kMission, {})});
  }
  std::set<int32_t> chunks;
  for (int turn = 0; turn < 20'000 && chunks.size() < kBricks; ++turn) {
    node.turn(1);
    int said = 0;
    listener_->receive(0, [&](const comms::Packet& packet) {
      const auto chunk = wire::decodeMap(packet.bytes);
      ASSERT_TRUE(chunk.ok());
      ++said;
      if (chunk->num_chunks == kBricks) chunks.insert(chunk->chunk);
    });
    ASSERT_LE(said, 8);
    if (said == 0)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));  // chunks are paced in wall time
  }
  EXPECT_EQ(chunks.size(), size_t{kBricks});
  node.finish();
  int last = 0;
  listener_->receive(0, [&](const comms::Packet&) { ++last; });
  EXPECT_EQ(last, kBricks);  // at the end all at once
}

// Each is killed as it has said its second word. What time it is then only what the next one hears can tell:
// at first nobody, then a robot that lags. With a second's bytes assumed spent, the next word comes a second
// after the last.
TEST_F(NodeTest, KeepsItsBudgetHoweverOftenItIsKilled) {
  for (const int64_t budget : {300, 2000}) {
    NodeOptions small = options();
    small.budget = budget;
    small.state_dir = testing::TempDir() + "shoal_node" + std::to_string(::getpid());
    std::filesystem::remove_all(small.state_dir);
    comms::WindowMeter meter(budget);
    double at_s = 10, last_word_s = -1;
    int words = 0;
    const auto turn = [&](Node& node) {
      node.turn(1);
      air_->receive(0, [&](const comms::Packet& packet) {
        if (!packet.channel.starts_with("SHOAL_OPERATOR_")) return;
        ++words;
        last_word_s = at_s;
        meter.add(std::llround(at_s * 1e6), comms::wireSize(packet));
      });
    };
    const auto hears = [&](const std::string& robot, double beat_s) {
      wire::Heartbeat beat;
      beat.mission = kMission;
      beat.time = {std::llround(beat_s * 1e6)};
      air_->publish({"SHOAL_" + robot + "_HEARTBEAT", wire::encode(beat)});
    };
    for (int life = 0; life < 6; ++life) {
      Node node(small, *ears_, *local_);
      const double killed_s = last_word_s;
      words = 0;
      if (life > 0) {
        turn(node);
        hears("R02", at_s - 3);
        turn(node);
      }
      for (const double patience_s = at_s + 60; words < 2 && at_s < patience_s;) {
        hears("R01", at_s += .1);
        turn(node);
        if (words > 0) {
          EXPECT_GT(at_s, killed_s + 1) << budget << " B/s, life " << life;
        }
      }
      EXPECT_GE(words, 2);
      ears_->receive(0, [](const comms::Packet&) {});  // what a dead process did not read is gone
    }
    EXPECT_TRUE(meter.worst().within_budget) << meter.worst().bytes;
    std::filesystem::remove_all(small.state_dir);
  }
}

TEST_F(NodeTest, RemembersTheLastHeartbeatThatItHeard) {
  NodeOptions remembering = options();
  remembering.state_dir = testing::TempDir() + "shoal_last" + std::to_string(::getpid());
  std::filesystem::remove_all(remembering.state_dir);
  {
    Node node(remembering, *ears_, *local_);
    for (const int64_t second : {1, 2, 3}) {
      wire::Heartbeat beat;
      beat.mission = kMission;
      beat.time = {second * 1'000'000};
      air_->publish({"SHOAL_R01_HEARTBEAT", wire::encode(beat)});
      node.turn(1);
    }
    node.finish();
  }
  MissionState remembered(kMission, {});
  NodeMemory(remembering.state_dir, "OPERATOR", kMission).recall(remembered);
  EXPECT_EQ(remembered.heartbeats().at("R01").time.seconds(), 3);
  std::filesystem::remove_all(remembering.state_dir);
}

}  // namespace
}  // namespace shoal::fusion_node
