// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/heartbeat_codec.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "examples.h"

namespace shoal::wire {
namespace {

TEST(HeartbeatCodecTest, KeepsEveryField) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const Heartbeat heartbeat = noiseHeartbeat(trial % 50, 1 + trial % 90, random);
    const auto decoded = decodeHeartbeat(encode(heartbeat));
    ASSERT_TRUE(decoded.ok()) << name(decoded.error());
    EXPECT_TRUE(*decoded == heartbeat);
    EXPECT_TRUE(std::signbit(decoded->z_m));  // -0 is its own bytes
  }
}

TEST(HeartbeatCodecTest, BatteryAndDepthTakeRoomWhenTheyAreKnown) {
  Random random(5);
  Heartbeat heartbeat = noiseHeartbeat(12, 1, random);
  heartbeat.learnt = 0;
  const auto size = [&heartbeat](int32_t battery_percent, int32_t depth_cm) {
    heartbeat.battery_percent = battery_percent;
    heartbeat.depth_cm = depth_cm;
    const Bytes bytes = encode(heartbeat);
    EXPECT_EQ(*decodeHeartbeat(bytes), heartbeat);
    return bytes.size();
  };
  const size_t without = size(-1, -1);
  EXPECT_EQ(size(0, -1), without + 2);
  EXPECT_EQ(size(100, -1), without + 2);
  EXPECT_EQ(size(-1, 0), without + 2);
  EXPECT_EQ(size(87, 1234), without + 3);
  EXPECT_EQ(size(87, std::numeric_limits<int32_t>::max()), without + 6);
}

TEST(HeartbeatCodecTest, WhoHasLandedSaysWhatItHasLearnt) {
  Heartbeat heartbeat;
  const size_t without = encode(heartbeat).size();
  for (const Phase phase : {Phase::kLanded, Phase::kLeaving, Phase::kListening}) {
    heartbeat.phase = phase;
    heartbeat.learnt = 0;  // as of builds before: battery and depth, or nothing, follow the roster
    heartbeat.battery_percent = -1;
    EXPECT_EQ(encode(heartbeat).size(), without);
    for (const uint32_t learnt : {1u, 0xffffffffu}) {
      for (const int32_t battery : {-1, 87}) {
        heartbeat.learnt = learnt;
        heartbeat.battery_percent = battery;
        const Bytes bytes = encode(heartbeat);
        EXPECT_EQ(bytes.size(), without + 6);
        EXPECT_EQ(*decodeHeartbeat(bytes), heartbeat);
      }
    }
  }
  for (const Phase phase : {Phase::kFlying, Phase::kNode}) {
    heartbeat.phase = phase;
    EXPECT_THROW(encode(heartbeat), std::invalid_argument);
  }
}

TEST(HeartbeatCodecTest, IsSmallForTwelveRobots) {
  Random random(2);
  for (int trial = 0; trial < 100; ++trial) {
    const Heartbeat heartbeat = noiseHeartbeat(12, 1, random);
    EXPECT_LT(encode(heartbeat).size(), hasLanded(heartbeat.phase) ? 266u : 260u);
  }
}

TEST(HeartbeatCodecTest, HoldsARosterOf256Robots) {
  Random random(3);
  const Heartbeat heartbeat = noiseHeartbeat(256, 1, random);
  const Bytes bytes = encode(heartbeat, maxPayload(30));
  EXPECT_LE(bytes.size(), maxPayload(30));
  const auto decoded = decodeHeartbeat(bytes);
  ASSERT_TRUE(decoded.ok());
  EXPECT_EQ(decoded->roster, heartbeat.roster);
}

TEST(HeartbeatCodecTest, CutsARosterThatDoesNotFitAtItsHighEnd) {
  Random random(4);
  const Heartbeat heartbeat = noiseHeartbeat(256, 39, random);
  for (const size_t max_payload : {223u, 500u, 1330u}) {
    const Bytes bytes = encode(heartbeat, max_payload);
    EXPECT_LE(bytes.size(), max_payload);
    EXPECT_GT(bytes.size() + 7, max_payload);  // another robot takes at most 7 bytes
    const auto decoded = decodeHeartbeat(bytes);
    ASSERT_TRUE(decoded.ok());
    ASSERT_LT(decoded->roster.size(), heartbeat.roster.size());
    EXPECT_TRUE(std::equal(decoded->roster.begin(), decoded->roster.end(), heartbeat.roster.begin()));
  }
}

TEST(HeartbeatCodecTest, RefusesToEncodeNonsense) {
  const auto broken = [](auto change) {
    Heartbeat heartbeat;
    change(heartbeat);
    EXPECT_THROW(encode(heartbeat), std::invalid_argument);
  };
  EXPECT_NO_THROW(encode(Heartbeat{}));
  broken([](Heartbeat& h) { h.time.us = -1; });
  broken([](Heartbeat& h) { h.epoch = -1; });
  broken([](Heartbeat& h) { h.observation = -2; });
  broken([](Heartbeat& h) { h.phase = static_cast<Phase>(5); });
  broken([](Heartbeat& h) { h.num_topics = 10001; });
  broken([](Heartbeat& h) { h.bytes_sent = -1; });
  broken([](Heartbeat& h) { h.x_m = std::numeric_limits<float>::quiet_NaN(); });
  broken([](Heartbeat& h) { h.ms_per_frame = std::numeric_limits<float>::infinity(); });
  broken([](Heartbeat& h) { h.cell_size_m = 0; });
  broken([](Heartbeat& h) { h.class_bytes[5] = -1; });
  broken([](Heartbeat& h) { h.battery_percent = 101; });
  broken([](Heartbeat& h) { h.battery_percent = -2; });
  broken([](Heartbeat& h) { h.depth_cm = -2; });
  broken([](Heartbeat& h) { h.roster = {{world::RobotId{2}, 0}, {world::RobotId{2}, 0}}; });
  broken([](Heartbeat& h) { h.roster = {{world::RobotId{10001}, 0}}; });
  EXPECT_THROW(encode(Heartbeat{}, 100), std::invalid_argument);
}

TEST(HeartbeatCodecTest, FoldsDigestsOfSharesByHalves) {
  EXPECT_EQ(shareDigest(0), 0u);
  EXPECT_EQ(shareDigest(0x00000001'00000000u), 1u);
  EXPECT_EQ(shareDigest(0x12345678'00000000u ^ 0x1u), 0x12345679u);
}

}  // namespace
}  // namespace shoal::wire
