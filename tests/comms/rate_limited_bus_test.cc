// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/rate_limited_bus.h"

#include <map>
#include <memory>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "fake_wall.h"
#include "shoal/comms/memory_bus.h"
#include "shoal/comms/stats.h"

namespace shoal::comms {
namespace {

Packet from(const std::string& node) { return {"SHOAL_" + node + "_X", {1}}; }

class RateLimitedBusTest : public testing::Test {
 protected:
  static RateLimits limits(FakeWall& wall) {
    RateLimits limits;
    limits.per_s = 100;
    limits.burst = 50;
    limits.new_nodes_per_s = 10;
    limits.new_nodes_burst = 20;
    limits.wall = wall.time();
    return limits;
  }
  // What came through since the last time, by channel.
  std::map<std::string, int> hear() {
    std::map<std::string, int> heard;
    bus_.receive(0, [&](const Packet& packet) { ++heard[packet.channel]; });
    return heard;
  }
  void say(const std::string& node, int times) {
    for (int i = 0; i < times; ++i) air_->publish(from(node));
  }

  FakeWall wall_;
  MemoryNetwork network_;
  std::unique_ptr<MemoryBus> air_ = network_.connect(), ears_ = network_.connect();
  RateLimitedBus bus_{*ears_, limits(wall_)};
};

TEST_F(RateLimitedBusTest, AFloodUnderOneNameLeavesTheOthersAlone) {
  Stats stats;
  bus_.countInto(stats);
  int flood = 0, quiet = 0;
  for (int second = 0; second < 10; ++second) {
    for (int i = 0; i < 10; ++i) {
      say("R07", 1000);
      say("R00", 5);
      auto heard = hear();
      flood += heard["SHOAL_R07_X"];
      quiet += heard["SHOAL_R00_X"];
      wall_.pass(100'000);
    }
  }
  EXPECT_EQ(quiet, 500);                // every one
  EXPECT_EQ(flood, 50 + 9 * 100 + 90);  // the burst, and the rate for the 9.9 s in between
  EXPECT_EQ(bus_.numDropped(), static_cast<uint64_t>(100'000 - flood));
  EXPECT_EQ(stats.rejected.at("too fast"), bus_.numDropped());
}

TEST_F(RateLimitedBusTest, WhoWaitsMaySayABurstAgain) {
  say("R00", 80);
  EXPECT_EQ(hear()["SHOAL_R00_X"], 50);
  wall_.pass(60'000'000);
  say("R00", 80);
  EXPECT_EQ(hear()["SHOAL_R00_X"], 50);
}

TEST_F(RateLimitedBusTest, EverNewNamesAreSlowedDownAndKnownOnesAreNot) {
  say("R00", 1);
  EXPECT_EQ(hear().size(), 1u);
  int strangers = 0, known = 0, next = 0;
  for (int second = 0; second < 30; ++second) {
    for (int i = 0; i < 1000; ++i) say("X" + std::to_string(next++), 1);
    say("R00", 20);
    auto heard = hear();
    known += heard["SHOAL_R00_X"];
    heard.erase("SHOAL_R00_X");
    strangers += static_cast<int>(heard.size());
    wall_.pass(1'000'000);
  }
  EXPECT_EQ(known, 600);
  EXPECT_EQ(strangers, 19 + 29 * 10);
}

// Who was silent for so long that it was forgotten comes back as anybody new does.
TEST_F(RateLimitedBusTest, NamesAreNotKeptWithoutEnd) {
  say("R00", 60);
  EXPECT_EQ(hear()["SHOAL_R00_X"], 50);
  for (size_t i = 0; i < RateLimitedBus::kMaxNodes; ++i) {
    wall_.pass(100'000);
    say("X" + std::to_string(i), 1);
    ASSERT_EQ(hear().size(), 1u) << i;
  }
  say("R00", 60);
  EXPECT_EQ(hear()["SHOAL_R00_X"], 50);
}

TEST_F(RateLimitedBusTest, SpeakingIsNotLimited) {
  for (int i = 0; i < 500; ++i) bus_.publish(from("R00"));
  int heard = 0;
  air_->receive(0, [&](const Packet&) { ++heard; });
  EXPECT_EQ(heard, 500);
}

TEST_F(RateLimitedBusTest, LimitsThatMeanNothingAreRefused) {
  for (const auto& change :
       {+[](RateLimits& l) { l.per_s = 0; }, +[](RateLimits& l) { l.burst = 0.5; },
        +[](RateLimits& l) { l.new_nodes_per_s = -1; }, +[](RateLimits& l) { l.new_nodes_burst = 0; }}) {
    RateLimits bad;
    change(bad);
    EXPECT_THROW(RateLimitedBus(*ears_, bad), std::invalid_argument);
  }
}

}  // namespace
}  // namespace shoal::comms
