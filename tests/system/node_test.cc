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

// A node keeps what time it is every 10 s. The first is killed some seconds after that, as it has said
// something.
TEST_F(NodeTest, KeepsItsBudgetHoweverOftenItIsKilled) {
  NodeOptions small = options();
  small.budget = 300;
  small.state_dir = testing::TempDir() + "shoal_node" + std::to_string(::getpid());
  std::filesystem::remove_all(small.state_dir);
  comms::WindowMeter meter(small.budget);
  const auto turnAt = [&](Node& node, double at_s) {
    wire::Heartbeat robot;
    robot.mission = kMission;
    robot.time = {std::llround(at_s * 1e6)};
    air_->publish({"SHOAL_R01_HEARTBEAT", wire::encode(robot)});
    node.turn(1);
    int said = 0;
    air_->receive(0, [&](const comms::Packet& packet) {
      if (!packet.channel.starts_with("SHOAL_OPERATOR_")) return;
      ++said;
      meter.add(robot.time.us, comms::wireSize(packet));
    });
    return said;
  };
  double at_s = 10;
  {
    Node first(small, *ears_, *local_);
    turnAt(first, at_s);
    for (at_s = 16; at_s < 19.5 && turnAt(first, at_s) == 0;) at_s += .1;
  }
  ASSERT_LT(at_s, 19.5);
  for (int life = 0; life < 4; ++life) {
    Node node(small, *ears_, *local_);
    for (int turn = 0; turn < 2; ++turn) EXPECT_EQ(turnAt(node, at_s += .1), 0) << at_s;
  }
  Node last(small, *ears_, *local_);
  int said = 0;
  for (const double end_s = at_s + 20; at_s < end_s;) said += turnAt(last, at_s += .1);
  EXPECT_GT(said, 0);
  EXPECT_TRUE(meter.worst().within_budget) << meter.worst().bytes;
  std::filesystem::remove_all(small.state_dir);
}

}  // namespace
}  // namespace shoal::fusion_node
