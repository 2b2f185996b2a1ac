// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/sender.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fake_wall.h"
#include "second.h"
#include "shoal/comms/memory_bus.h"
#include "shoal/comms/window_meter.h"
#include "shoal/random.h"

namespace shoal::comms {
namespace {

Packet packet(const std::string& channel, size_t size, uint8_t fill = 0) {
  return {channel, Bytes(size, fill)};
}

// A sender on a bus that keeps what it hears.
struct Node {
  explicit Node(SenderOptions options) : bus(network.connect()), local(local_network.connect()) {
    options.wall = wall.time();
    sender.emplace(*bus, local.get(), std::move(options));
  }

  std::vector<Packet> heard() {
    std::vector<Packet> packets;
    bus->receive(0, [&](const Packet& heard) { packets.push_back(heard); });
    return packets;
  }

  FakeWall wall;
  MemoryNetwork network;
  MemoryNetwork local_network;
  std::unique_ptr<MemoryBus> bus;
  std::unique_ptr<MemoryBus> local;
  std::optional<Sender> sender;
};

TEST(SenderTest, StaysInBudgetAndUsesIt) {
  // Datagrams of 20 to 1320 bytes: what the windows allow is less than the budget, see BudgetTest.
  const std::map<int64_t, double> least_content = {{250, 0.33}, {1000, 0.42}, {2000, 0.55}, {20000, 0.92}};
  for (const auto& [bytes_per_s, least] : least_content) {
    SCOPED_TRACE(bytes_per_s);
    Node node({.bytes_per_s = bytes_per_s,
               .make_heartbeat = [](int64_t) { return packet("SHOAL_R00_HEARTBEAT", 80); }});
    WindowMeter meter(bytes_per_s);
    Random random(7);
    int64_t bytes = 0;
    int64_t now_us = 0;
    int64_t frame_us = 0;
    const int64_t end_us = 300 * kSecond;
    int n = 0;
    while (now_us < end_us) {
      if (now_us >= frame_us) {
        for (int i = 0; i < 40; ++i) {
          node.sender->offer(static_cast<TrafficClass>(1 + i % 4), std::to_string(i),
                             packet("SHOAL_R00_X", 20 + random.below(1300), static_cast<uint8_t>(n++)));
        }
        frame_us += kSecond;
      }
      const int64_t next_us = node.sender->pump(now_us);
      for (const Packet& each : node.heard()) {
        meter.add(now_us, wireSize(each));
        bytes += static_cast<int64_t>(wireSize(each));
      }
      ASSERT_GT(next_us, now_us);
      now_us = std::min(next_us, frame_us);
    }
    EXPECT_TRUE(meter.worst().within_budget) << meter.worst().share;
    const double share = static_cast<double>(bytes) * 1e6 / static_cast<double>(bytes_per_s * end_us);
    EXPECT_LE(share, 1.0);
    EXPECT_EQ(node.sender->stats().linkBytes(), static_cast<uint64_t>(bytes));
    EXPECT_LE(node.sender->worstWindow().bytes, node.sender->worstWindow().budget);
    const Stats& stats = node.sender->stats();
    const auto heartbeats = static_cast<double>(stats.of(TrafficClass::kHeartbeat).bytes);
    EXPECT_GT((static_cast<double>(bytes) - heartbeats) * 1e6 / static_cast<double>(bytes_per_s * end_us),
              least);
    EXPECT_LE(heartbeats, static_cast<double>(bytes_per_s * 300 / 10 + 136));
    EXPECT_GE(stats.of(TrafficClass::kHeartbeat).datagrams, 15u);
    for (int c = 1; c <= 4; ++c) EXPECT_GT(node.sender->stats().sent[static_cast<size_t>(c)].datagrams, 2u);
  }
}

// Full datagrams, which windows carry the least of, and pieces of any size.
TEST(SenderTest, SaysAtLeastSoMuchContentASecond) {
  for (const int64_t bytes_per_s : {50, 200, 1000, 2000, 5000, 20000})
    for (const bool is_full : {true, false}) {
      SCOPED_TRACE(std::to_string(bytes_per_s) + (is_full ? " full" : " of any size"));
      Node node({.bytes_per_s = bytes_per_s,
                 .make_heartbeat = [](int64_t) { return packet("SHOAL_R00_HEARTBEAT", 150); }});
      Random random(3);
      const int64_t end_us = 600'000'000'000 / bytes_per_s;
      int n = 0;
      for (int64_t now_us = 0; now_us < end_us;) {
        while (node.sender->queue().numWaiting(TrafficClass::kBricks) < 1100) {
          const size_t size = is_full ? kMaxMessageBytes - 20 : 20 + random.below(1300);
          node.sender->offer(TrafficClass::kBricks, std::to_string(n++), packet("SHOAL_R00_B", size));
        }
        now_us = node.sender->pump(now_us);
        node.heard();
      }
      const auto content = static_cast<double>(node.sender->stats().of(TrafficClass::kBricks).bytes);
      EXPECT_GT(content * 1e6 / static_cast<double>(end_us), 0.97 * contentPerSecond(bytes_per_s));
    }
}

TEST(SenderTest, BeatsOnceASecondWhenTheBudgetAllows) {
  std::vector<int64_t> beats;
  Node node({.make_heartbeat = [&](int64_t now_us) {
    beats.push_back(now_us);
    return packet("SHOAL_R00_HEARTBEAT", 80);
  }});
  int64_t now_us = 500;
  for (int i = 0; i < 4; ++i) now_us = node.sender->pump(now_us);
  EXPECT_EQ(beats, (std::vector<int64_t>{500, kSecond + 500, 2 * kSecond + 500, 3 * kSecond + 500}));
}

TEST(SenderTest, StretchesTheHeartbeatToAFifthOfAThinLink) {
  std::vector<int64_t> beats;
  Node node({.bytes_per_s = 100, .make_heartbeat = [&](int64_t now_us) {
               beats.push_back(now_us);
               return packet("SHOAL_R00_HEARTBEAT", 94);  // 150 bytes on the wire: 5 x 150 / 100 = 7.5 s
             }});
  int64_t now_us = 0;
  for (int i = 0; i < 3; ++i) now_us = node.sender->pump(now_us);
  EXPECT_EQ(beats, (std::vector<int64_t>{0, 7'500'000, 15'000'000}));
}

// 150 bytes on the wire: 10 x 150 / 100 = 15 s.
TEST(SenderTest, StretchesItToATenthWhileContentWaits) {
  Node node(
      {.bytes_per_s = 100, .make_heartbeat = [](int64_t) { return packet("SHOAL_R00_HEARTBEAT", 94); }});
  std::vector<int64_t> beats;
  int n = 0;
  for (int64_t now_us = 0; now_us < 60 * kSecond; now_us += kSecond / 10) {
    if (now_us < 40 * kSecond) {  // always more to say
      for (int i = 0; i < 3; ++i)
        node.sender->offer(TrafficClass::kTopics, std::to_string(n++), packet("SHOAL_R00_T", 52));
    } else {
      for (; n > 0; --n) node.sender->forget(std::to_string(n - 1));  // then nothing
    }
    node.sender->pump(now_us);
    for (const Packet& sent : node.heard())
      if (sent.channel == "SHOAL_R00_HEARTBEAT") beats.push_back(now_us);
  }
  ASSERT_EQ(beats.size(), 6u);
  for (size_t i = 1; i < 3; ++i) {
    EXPECT_GE(beats[i] - beats[i - 1], 15 * kSecond);
    EXPECT_LE(beats[i] - beats[i - 1], 18 * kSecond);  // as soon as the budget lets it
  }
  EXPECT_LE(beats[3], 42'500'000);  // overdue when nothing waits
  EXPECT_EQ(beats[4], beats[3] + 7'500'000);
}

TEST(SenderTest, NothingOvertakesAHeartbeatThatWaitsForTheBudget) {
  Node node(
      {.bytes_per_s = 1000, .make_heartbeat = [](int64_t) { return packet("SHOAL_R00_H", 152); }});  // 200
  node.sender->pump(0);
  for (int i = 0; i < 7; ++i) {
    node.sender->offer(TrafficClass::kTopics, std::to_string(i), packet("SHOAL_R00_T", 52));  // 100 each
  }
  EXPECT_EQ(node.sender->pump(600'000), kSecond);  // 200 + 700 bytes went, a heartbeat is due next
  EXPECT_EQ(node.heard().size(), 8u);
  node.sender->offer(TrafficClass::kTopics, "late", packet("SHOAL_R00_T", 52));
  node.sender->hurryHeartbeat(kSecond);
  // 100 more would fit at 1 s, but the heartbeat's 200 do not before 1.1 s.
  EXPECT_EQ(node.sender->pump(kSecond), 1'100'000);
  EXPECT_TRUE(node.heard().empty());
  node.sender->pump(1'100'000);
  EXPECT_EQ(node.heard().front().channel, "SHOAL_R00_H");
}

// 136 bytes a second leave a gap of 1 s; 1428 bytes need 1.564 s after them.
TEST(SenderTest, HeartbeatsDoNotStarveADatagramThatNeedsALongGap) {
  Node node(
      {.bytes_per_s = 1000, .make_heartbeat = [](int64_t) { return packet("SHOAL_R00_HEARTBEAT", 80); }});
  int64_t now_us = node.sender->pump(0);
  node.sender->offer(TrafficClass::kBricks, "large", packet("SHOAL_R00_B", kMaxMessageBytes - 20));
  for (int i = 0; i < 3; ++i) now_us = node.sender->pump(now_us);
  EXPECT_EQ(node.sender->stats().of(TrafficClass::kBricks).datagrams, 1u);
  EXPECT_GE(node.sender->stats().of(TrafficClass::kHeartbeat).datagrams, 1u);
}

TEST(SenderTest, StampsTheTimeOfSendingAndKeepsTheContent) {
  Node node({.queue = {.min_resend_interval_us = 10, .max_resends = 5},
             .stamp = [](Packet& sent, int64_t now_us) { sent.bytes[0] = static_cast<uint8_t>(now_us); }});
  node.sender->offer(TrafficClass::kTopics, "a", packet("SHOAL_R00_T", 3));
  EXPECT_EQ(node.sender->pump(7), 17);
  EXPECT_EQ(node.sender->pump(17), 27);
  const auto heard = node.heard();
  ASSERT_EQ(heard.size(), 2u);
  EXPECT_EQ(heard[0].bytes, (Bytes{7, 0, 0}));
  EXPECT_EQ(heard[1].bytes, (Bytes{17, 0, 0}));
  EXPECT_EQ(node.sender->stats().of(TrafficClass::kTopics).resent_datagrams, 1u);
  node.sender->offer(TrafficClass::kTopics, "a", packet("SHOAL_R00_T", 3));  // still the same
  EXPECT_EQ(node.sender->queue().waitingBytes(), 0);
}

TEST(SenderTest, SaysNeverWhenThereIsNothingToSend) {
  Node node({});
  EXPECT_EQ(node.sender->pump(0), Sender::kNever);
}

TEST(SenderTest, LocalPacketsAreCountedApartAndCostNoBudget) {
  Node node({.bytes_per_s = 100});
  for (int i = 0; i < 50; ++i) node.sender->sendLocal(packet("SHOAL_OPERATOR_MAP", 1000));
  EXPECT_EQ(node.local->receive(0, [](const Packet&) {}), 50);
  EXPECT_TRUE(node.heard().empty());
  EXPECT_EQ(node.sender->stats().linkBytes(), 0u);
  EXPECT_EQ(node.sender->stats().of(TrafficClass::kLocal).datagrams, 50u);
  EXPECT_EQ(node.sender->worstWindow().bytes, 0);
  EXPECT_GE(node.wall.now(), 123'456 + (50 - 8) * 1000);
}

TEST(SenderTest, ALocalPacketThatWouldWaitIsLeftToTheCaller) {
  Node node({});
  const Packet chunk = packet("SHOAL_OPERATOR_MAP", 1000);
  int sent = 0;
  while (node.sender->trySendLocal(chunk)) ++sent;
  EXPECT_EQ(sent, 8);  // a burst
  node.wall.pass(3000);
  while (node.sender->trySendLocal(chunk)) ++sent;
  EXPECT_EQ(sent, 8 + 3);
  EXPECT_EQ(node.local->receive(0, [](const Packet&) {}), sent);
  EXPECT_EQ(node.sender->stats().of(TrafficClass::kLocal).datagrams, 11u);
  EXPECT_TRUE(node.wall.sleeps().empty());
}

TEST(SenderTest, AfterACrashWaitsUntilNoWindowCanBeOverBudget) {
  const SenderOptions options{.bytes_per_s = 1000};
  WindowMeter meter(1000);
  int64_t now_us = 0;
  for (int life = 0; life < 5; ++life) {
    Node node(options);
    if (life > 0) node.sender->assumeExhausted(now_us);
    for (int i = 0; i < 100; ++i)
      node.sender->offer(TrafficClass::kBricks, std::to_string(i), packet("SHOAL_R00_B", 300));
    for (int steps = 0; steps < 10; ++steps) {
      const int64_t next_us = node.sender->pump(now_us);
      for (const Packet& each : node.heard()) meter.add(now_us, wireSize(each));
      if (steps < 9) now_us = next_us;
    }
  }
  EXPECT_TRUE(meter.worst().within_budget) << meter.worst().share;
}

// Losses heal: whatever is lost, everybody ends up with the newest content of every key.
TEST(SenderTest, RepetitionHealsALossyNetwork) {
  MemoryNetwork network({.seed = 3, .loss = 0.4, .duplication = 0.1, .reordering = 0.3});
  const auto bus = network.connect();
  const auto listener = network.connect();
  FakeWall wall;
  Sender sender(*bus, nullptr, {.bytes_per_s = 5000, .queue = {.max_resends = 100}, .wall = wall.time()});
  for (int i = 0; i < 30; ++i)
    sender.offer(TrafficClass::kTopics, std::to_string(i),
                 packet("SHOAL_R00_T", 400, static_cast<uint8_t>(i)));
  std::vector<bool> got(30);
  for (int64_t now_us = 0; now_us < 200 * kSecond; now_us = sender.pump(now_us)) {
    listener->receive(0, [&](const Packet& heard) { got[heard.bytes[0]] = true; });
  }
  EXPECT_EQ(std::ranges::count(got, true), 30);
}

TEST(WallPacerTest, LetsABurstOutAndThenKeepsTheRate) {
  FakeWall wall;
  const int64_t start_us = wall.now();
  WallPacer pacer({.gap_us = 1000, .burst = 8}, wall.time());
  std::vector<int64_t> times;
  for (int i = 0; i < 1000; ++i) {
    pacer.pace();
    times.push_back(wall.now() - start_us);
  }
  EXPECT_EQ(times[7], 0);
  EXPECT_GT(times[8], 0);
  for (size_t i = 0; i < times.size(); ++i) {
    for (size_t j = i; j < times.size(); ++j) {  // never more than burst + t / gap in any t
      ASSERT_LE(static_cast<int64_t>(j - i + 1), 8 + (times[j] - times[i]) / 1000) << i << ' ' << j;
    }
  }
  EXPECT_LE(times.back(), 1000 * 1000);  // and no slower than the gap
}

TEST(WallPacerTest, DoesNotSleepWhenTimePassesAnyway) {
  FakeWall wall;
  WallPacer pacer({}, wall.time());
  for (int i = 0; i < 100; ++i) {
    pacer.pace();
    wall.pass(1000);
  }
  EXPECT_TRUE(wall.sleeps().empty());
}

TEST(WallPacerTest, RejectsOptionsOutOfRange) {
  EXPECT_THROW(WallPacer({.gap_us = -1}), std::invalid_argument);
  EXPECT_THROW(WallPacer({.burst = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace shoal::comms
