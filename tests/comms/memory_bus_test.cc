// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/memory_bus.h"

#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace shoal::comms {
namespace {

Packet numbered(int n) {
  return {"SHOAL_R00_X", {static_cast<uint8_t>(n / 256), static_cast<uint8_t>(n % 256)}};
}

std::vector<int> hearNumbers(Bus& bus) {
  std::vector<int> numbers;
  bus.receive(0, [&](const Packet& packet) { numbers.push_back(packet.bytes[0] * 256 + packet.bytes[1]); });
  return numbers;
}

TEST(MemoryBusTest, EverybodyHearsEverybodyInOrder) {
  MemoryNetwork network;
  const auto a = network.connect();
  const auto b = network.connect();
  a->publish(numbered(1));
  b->publish(numbered(2));
  a->publish(numbered(3));
  EXPECT_EQ(hearNumbers(*a), (std::vector{1, 2, 3}));
  EXPECT_EQ(hearNumbers(*b), (std::vector{1, 2, 3}));
  EXPECT_TRUE(hearNumbers(*b).empty());
}

TEST(MemoryBusTest, AHandlerMayPublish) {
  MemoryNetwork network;
  const auto a = network.connect();
  a->publish(numbered(1));
  EXPECT_EQ(a->receive(0, [&](const Packet&) { a->publish(numbered(2)); }), 1);
  EXPECT_EQ(hearNumbers(*a), std::vector{2});
}

TEST(MemoryBusTest, LosesDoublesAndReordersAsOftenAsToldAndAlikeForASeed) {
  const auto run = [](uint64_t seed) {
    MemoryNetwork network({.seed = seed, .loss = 0.25, .duplication = 0.1, .reordering = 0.2});
    const auto a = network.connect();
    const auto b = network.connect();
    for (int n = 0; n < 10000; ++n) a->publish(numbered(n));
    EXPECT_EQ(hearNumbers(*a).size(), 10000u);  // oneself without fail
    return hearNumbers(*b);
  };
  const std::vector<int> heard = run(1);
  EXPECT_EQ(heard, run(1));
  EXPECT_NE(heard, run(2));
  EXPECT_NEAR(static_cast<double>(heard.size()), 10000 * 0.75 * 1.1, 250);
  int backwards = 0;
  for (size_t i = 1; i < heard.size(); ++i) backwards += heard[i] < heard[i - 1] ? 1 : 0;
  EXPECT_GT(backwards, 500);
  for (size_t i = 0; i < heard.size(); ++i) EXPECT_GT(heard[i], static_cast<int>(i) - 4000);
}

TEST(MemoryBusTest, APartitionSeparatesUntilItHeals) {
  MemoryNetwork network;
  const auto a = network.connect();
  const auto b = network.connect();
  const auto c = network.connect();
  network.partition({0, 1, 0});
  a->publish(numbered(1));
  EXPECT_EQ(hearNumbers(*a), std::vector{1});
  EXPECT_TRUE(hearNumbers(*b).empty());
  EXPECT_EQ(hearNumbers(*c), std::vector{1});
  network.heal();
  b->publish(numbered(2));
  EXPECT_EQ(hearNumbers(*a), std::vector{2});
}

TEST(MemoryBusTest, RejectsWhatIsNoNetwork) {
  EXPECT_THROW(MemoryNetwork({.loss = 1.5}), std::invalid_argument);
  EXPECT_THROW(MemoryNetwork({.reordering = -0.1}), std::invalid_argument);
  MemoryNetwork network;
  const auto a = network.connect();
  EXPECT_THROW(network.partition({0, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace shoal::comms
