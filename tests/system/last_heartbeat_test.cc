// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/last_heartbeat.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "shoal/comms/memory_bus.h"

namespace shoal::fusion_node {
namespace {

using comms::TrafficClass;

constexpr int64_t kSecondUs = 1'000'000;

class LastHeartbeatTest : public testing::Test {
 protected:
  // Wall time that passes by sleeping alone.
  comms::WallTime wall() {
    return {[this] { return wall_us_; }, [this](int64_t us) { wall_us_ += us; }};
  }
  comms::Sender sender(int64_t budget) {
    comms::SenderOptions options;
    options.bytes_per_s = budget;
    options.wall = wall();
    options.make_heartbeat = [](int64_t) {
      return comms::Packet{"SHOAL_R00_HEARTBEAT", std::vector<uint8_t>(300)};
    };
    return {*bus_, nullptr, options};
  }
  static uint64_t beats(const comms::Sender& sender) {
    return sender.stats().of(TrafficClass::kHeartbeat).datagrams;
  }

  int64_t wall_us_ = 0;
  comms::MemoryNetwork network_;
  const std::unique_ptr<comms::MemoryBus> bus_ = network_.connect();
};

TEST_F(LastHeartbeatTest, GoesAtOnceWhenThereIsBudget) {
  for (const double rate : {0.0, 1.0}) {
    comms::MissionClock clock(rate, 0, wall());
    comms::Sender told = sender(0);
    told.pump(clock.now());
    ASSERT_EQ(beats(told), 1u);
    const int64_t before_us = wall_us_;
    EXPECT_TRUE(sayLastHeartbeat(told, clock));
    EXPECT_EQ(beats(told), 2u);
    EXPECT_LT(wall_us_ - before_us, kSecondUs / 10);  // what pacing takes
  }
}

TEST_F(LastHeartbeatTest, WaitsForTheBudgetButNotForLong) {
  comms::MissionClock clock(1, 0, wall());
  comms::Sender told = sender(300);
  told.pump(clock.now());
  EXPECT_TRUE(sayLastHeartbeat(told, clock));
  EXPECT_EQ(beats(told), 2u);

  comms::Sender thin = sender(10);
  thin.pump(clock.now());
  const int64_t before_us = wall_us_;
  EXPECT_FALSE(sayLastHeartbeat(thin, clock));
  EXPECT_LE(wall_us_ - before_us, 3 * kSecondUs);
  EXPECT_EQ(beats(thin), 1u);

  comms::MissionClock fast(0, 0, wall());  // there no wall time passes
  comms::Sender thin_and_fast = sender(10);
  thin_and_fast.pump(0);
  EXPECT_TRUE(sayLastHeartbeat(thin_and_fast, fast));
}

TEST_F(LastHeartbeatTest, WhatStillWaitsDoesNotKeepItForLong) {
  comms::MissionClock clock(1, 0, wall());
  comms::Sender told = sender(1000);
  for (int i = 0; i < 50; ++i)
    told.offer(TrafficClass::kBricks, std::to_string(i), {"SHOAL_R00_BRICK", std::vector<uint8_t>(400)});
  told.pump(clock.now());
  const uint64_t before = beats(told);
  EXPECT_TRUE(sayLastHeartbeat(told, clock));
  EXPECT_EQ(beats(told), before + 1);
}

}  // namespace
}  // namespace shoal::fusion_node
