// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/authenticated_bus.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fake_wall.h"
#include "shoal/comms/memory_bus.h"
#include "shoal/comms/sender.h"
#include "shoal/comms/window_meter.h"
#include "shoal/random.h"

namespace shoal::comms {
namespace {

SealKey keyOf(uint8_t fill) {
  std::array<uint8_t, SealKey::kBytes> secret{};
  secret.fill(fill);
  return SealKey(secret);
}

// In these tests a whole message is two bytes, so that none is with a seal behind it, whatever the seal.
bool hasTwoBytes(std::span<const uint8_t> bytes) { return bytes.size() == 2; }

Packet message(const std::string& node, uint8_t n) { return {"SHOAL_" + node + "_X", {n, 0}}; }

std::vector<Packet> hear(Bus& bus) {
  std::vector<Packet> heard;
  bus.receive(0, [&](const Packet& packet) { heard.push_back(packet); });
  return heard;
}

// Two of a team, and the air between them, on which anybody can speak and listen.
class AuthenticatedBusTest : public testing::Test {
 protected:
  MemoryNetwork network_;
  std::unique_ptr<MemoryBus> air_ = network_.connect(), air_a_ = network_.connect(),
                             air_b_ = network_.connect();
  AuthenticatedBus a_{*air_a_, keyOf(1), hasTwoBytes}, b_{*air_b_, keyOf(1), hasTwoBytes};
};

TEST_F(AuthenticatedBusTest, WhoHasTheKeyIsHeardUnchanged) {
  a_.publish(message("R00", 7));
  for (Bus* bus : std::initializer_list<Bus*>{&a_, &b_}) {
    const auto heard = hear(*bus);
    ASSERT_EQ(heard.size(), 1u);
    EXPECT_EQ(heard[0].channel, "SHOAL_R00_X");
    EXPECT_EQ(heard[0].bytes, (Bytes{7, 0}));
    EXPECT_EQ(wireSize(heard[0]), wireSize(message("R00", 7)) + kSealBytes);
  }
  const auto on_air = hear(*air_);
  ASSERT_EQ(on_air.size(), 1u);
  EXPECT_EQ(on_air[0].bytes.size(), 2 + kSealBytes);
  EXPECT_EQ(b_.counts().accepted, 1u);
  EXPECT_TRUE(b_.strangers().empty());
}

TEST_F(AuthenticatedBusTest, StrangersAreNotHeardButKnown) {
  Stats stats;
  b_.countInto(stats);
  AuthenticatedBus other(*air_, keyOf(2), hasTwoBytes);
  for (int i = 0; i < 3; ++i) air_->publish(message("R07", 1));
  for (int i = 0; i < 2; ++i) other.publish(message("R08", 1));
  air_->publish({"SHOAL_R09_X", {}});
  a_.publish(message("R00", 7));
  EXPECT_EQ(hear(b_).size(), 1u);
  EXPECT_EQ(b_.counts().no_key, 3u);
  EXPECT_EQ(b_.counts().other_key, 3u);
  EXPECT_EQ(stats.rejected.at("without a key"), 3u);
  EXPECT_EQ(stats.rejected.at("not of our key"), 3u);
  ASSERT_EQ(b_.strangers().size(), 3u);
  EXPECT_EQ(b_.strangers().at("R07").messages, 3u);
  EXPECT_FALSE(b_.strangers().at("R07").has_a_seal);
  EXPECT_EQ(b_.strangers().at("R08").messages, 2u);
  EXPECT_TRUE(b_.strangers().at("R08").has_a_seal);
}

TEST_F(AuthenticatedBusTest, NamesOfStrangersAreNotKeptWithoutEnd) {
  for (int i = 0; i < 500; ++i) air_->publish(message("X" + std::to_string(i), 1));
  EXPECT_TRUE(hear(b_).empty());
  EXPECT_EQ(b_.strangers().size(), AuthenticatedBus::kMaxStrangers);
  EXPECT_EQ(b_.counts().no_key, 500u);
}

TEST_F(AuthenticatedBusTest, EveryFlippedBitOfTheAirIsRefused) {
  a_.publish(message("R00", 7));
  const Packet sealed = hear(*air_).at(0);
  hear(b_);
  for (size_t bit = 0; bit < 8 * sealed.bytes.size(); ++bit) {
    Packet altered = sealed;
    altered.bytes[bit / 8] ^= static_cast<uint8_t>(1 << (bit % 8));
    air_->publish(altered);
  }
  Packet renamed = sealed;
  renamed.channel = "SHOAL_R01_X";
  air_->publish(renamed);
  EXPECT_TRUE(hear(b_).empty());
  EXPECT_EQ(b_.counts().other_key + b_.counts().no_key, 8 * sealed.bytes.size() + 1);
}

TEST_F(AuthenticatedBusTest, WhatIsRepeatedIsHeardOnce) {
  for (uint8_t i = 0; i < 50; ++i) a_.publish(message("R00", i));
  auto recorded = hear(*air_);
  std::ranges::reverse(recorded);  // reordered on the way: fine
  hear(b_);
  EXPECT_EQ(b_.counts().accepted, 50u);
  for (const Packet& packet : recorded) air_->publish(packet);
  EXPECT_TRUE(hear(b_).empty());
  EXPECT_EQ(b_.counts().replayed, 50u);
  a_.publish(message("R00", 99));
  EXPECT_EQ(hear(b_).size(), 1u);
  EXPECT_TRUE(b_.strangers().empty());
}

TEST_F(AuthenticatedBusTest, ReorderingLosesNothing) {
  MemoryNetwork bad({.seed = 3, .loss = 0, .duplication = 0.3, .reordering = 0.5});
  const auto from = bad.connect(), to = bad.connect();
  AuthenticatedBus a(*from, keyOf(1), hasTwoBytes), b(*to, keyOf(1), hasTwoBytes);
  for (int i = 0; i < 3000; ++i) a.publish(message("R00", static_cast<uint8_t>(i)));
  EXPECT_EQ(hear(b).size(), 3000u);
  EXPECT_GT(b.counts().replayed, 500u);  // the doubles
}

// Who comes back after a crash begins another session; what it said in the one before stays said.
TEST_F(AuthenticatedBusTest, ARestartedSenderIsHeardAndItsPastIsNot) {
  for (uint8_t i = 0; i < 5; ++i) a_.publish(message("R00", i));
  const auto recorded = hear(*air_);
  EXPECT_EQ(hear(b_).size(), 5u);
  AuthenticatedBus again(*air_a_, keyOf(1), hasTwoBytes);
  again.publish(message("R00", 0));
  EXPECT_EQ(hear(b_).size(), 1u);
  for (const Packet& packet : recorded) air_->publish(packet);
  EXPECT_TRUE(hear(b_).empty());
}

TEST_F(AuthenticatedBusTest, ManySessionsAreForgottenOldestFirst) {
  a_.publish(message("R00", 1));
  const Packet first = hear(*air_).at(0);
  hear(b_);
  for (size_t i = 0; i < AuthenticatedBus::kMaxSessions; ++i) {
    Packet packet = message("R01", 1);
    addSeal(keyOf(1), {static_cast<uint32_t>(i), 0}, packet);
    air_->publish(packet);
  }
  EXPECT_EQ(hear(b_).size(), AuthenticatedBus::kMaxSessions);
  air_->publish(first);  // bounded memory has its price: docs/security.md
  EXPECT_EQ(hear(b_).size(), 1u);
}

// The budget is about what is on the air: seals are in it.
TEST_F(AuthenticatedBusTest, SealsAreInTheBudget) {
  constexpr int64_t kBudget = 1000;
  FakeWall wall;
  SenderOptions options;
  options.bytes_per_s = kBudget;
  options.wall = wall.time();
  options.make_heartbeat = [](int64_t) { return Packet{"SHOAL_R00_HEARTBEAT", Bytes(80, 0)}; };
  options.most_joined_bytes = 600;
  options.join = [](std::span<const SendQueue::Next> together) -> std::optional<Packet> {
    Packet joined{together.front().packet->channel, {}};
    for (const SendQueue::Next& each : together)
      joined.bytes.insert(joined.bytes.end(), each.packet->bytes.begin(), each.packet->bytes.end());
    return joined;
  };
  Sender sender(a_, nullptr, std::move(options));
  WindowMeter meter(kBudget);
  int64_t bytes = 0;
  for (int64_t now_us = 0; now_us < 60'000'000;) {
    for (int i = 0; i < 20; ++i) {
      sender.offer(TrafficClass::kBricks, std::to_string(i),
                   {"SHOAL_R00_X", Bytes(100 + static_cast<size_t>(i) * 9, static_cast<uint8_t>(now_us))});
    }
    const int64_t next_us = sender.pump(now_us);
    for (const Packet& each : hear(*air_)) {
      meter.add(now_us, wireSize(each));
      bytes += static_cast<int64_t>(wireSize(each));
    }
    now_us = next_us;
  }
  EXPECT_TRUE(meter.worst().within_budget) << meter.worst().share;
  EXPECT_GT(bytes, 60 * kBudget / 2);
  EXPECT_EQ(sender.stats().linkBytes(), static_cast<uint64_t>(bytes));
}

TEST_F(AuthenticatedBusTest, AFullMessageLeavesRoomForTheSeal) {
  Sender sender(a_, nullptr, {});
  const std::string channel = "SHOAL_R00_X";
  const size_t most = kMaxMessageBytes - 8 - channel.size() - 1 - kSealBytes;
  EXPECT_NO_THROW(sender.offer(TrafficClass::kBricks, "a", {channel, Bytes(most, 0)}));
  EXPECT_THROW(sender.offer(TrafficClass::kBricks, "b", {channel, Bytes(most + 1, 0)}),
               std::invalid_argument);
}

}  // namespace
}  // namespace shoal::comms
