// SPDX-License-Identifier: BSD-3-Clause
// What a sender says waits is what it then sends, and every class drains.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "fake_wall.h"
#include "shoal/comms/sender.h"
#include "shoal/random.h"

namespace shoal::comms {
namespace {

constexpr std::array kQueued = {TrafficClass::kMatches,   TrafficClass::kTopics,   TrafficClass::kBricks,
                                TrafficClass::kCertainty, TrafficClass::kPictures, TrafficClass::kRequests,
                                TrafficClass::kRepairs};

class Counter : public Bus {
 public:
  void publish(const Packet& packet) override {
    bytes[packet.channel] += static_cast<int64_t>(wireSize(packet));
    ++datagrams;
  }
  int receive(int, const std::function<void(const Packet&)>&) override { return 0; }
  std::map<std::string, int64_t> bytes;
  int datagrams = 0;
};

Packet packetWith(const std::string& channel, size_t size, uint64_t content) {
  Packet made{channel, Bytes(size)};
  for (size_t i = 0; i < std::min<size_t>(size, 8); ++i)
    made.bytes[i] = static_cast<uint8_t>(content >> 8 * i);
  return made;
}

// Bricks and certainties share datagrams: 24 bytes of each are said once for all, and what remains takes
// four fifths of the room.
std::optional<Packet> share(std::span<const SendQueue::Next> together) {
  const TrafficClass traffic = together.front().traffic;
  if (traffic != TrafficClass::kBricks && traffic != TrafficClass::kCertainty) return std::nullopt;
  size_t size = 24;
  for (const SendQueue::Next& next : together) size += (next.packet->bytes.size() - 24) * 4 / 5;
  return Packet{together.front().packet->channel, Bytes(size)};
}

SenderOptions sharing(int64_t bytes_per_s, FakeWall& wall) {
  SenderOptions options;
  options.bytes_per_s = bytes_per_s;
  options.wall = wall.time();
  options.join = share;
  options.most_joined_bytes = 600;
  return options;
}

TEST(BacklogTest, IsWhatIsThenSentUntilNothingWaits) {
  Random random(11);
  for (int trial = 0; trial < 200; ++trial) {
    Counter bus;
    FakeWall wall;
    Sender sender(bus, nullptr, sharing(trial % 2 == 0 ? 0 : 1000, wall));
    const uint64_t most = 1 + random.below(trial % 3 == 0 ? 12 : 400);
    const auto offerSome = [&](uint64_t count) {
      for (uint64_t i = 0; i < count; ++i) {
        const TrafficClass traffic = kQueued[random.below(5)];
        const std::string channel = "SHOAL_R00_" + std::to_string(static_cast<int>(traffic));
        // Those that wait longer are smaller, as a robot's first bricks are.
        const size_t size = 25 + i * 100 / most + random.below(60);
        sender.offer(traffic, channel + std::to_string(random.below(2 * most)),
                     packetWith(channel, size, random()));
      }
    };
    offerSome(most);
    int64_t next_us = 0;
    if (trial % 5 == 0) {  // some has gone already, and more has come
      for (int i = 0; i < 5; ++i) next_us = std::min<int64_t>(sender.pump(next_us), next_us + 1'000'000);
      offerSome(most / 2 + 1);
    }
    const auto sent_before = static_cast<int64_t>(sender.stats().linkBytes());
    const int64_t published = sender.backlog();
    EXPECT_EQ(published > 0, sender.queue().waitingBytes() > 0);
    while (sender.queue().waitingBytes() > 0) next_us = sender.pump(next_us);
    const auto sent = static_cast<int64_t>(sender.stats().linkBytes()) - sent_before;
    EXPECT_LE(published, sent * 11 / 10) << trial;
    EXPECT_GE(published, sent * 10 / 11) << trial;
    EXPECT_EQ(sender.backlog(), 0);
  }
}

// What waits comes and goes. A fifth: an eighth may be other than at the last trial, and that is as coarse.
TEST(BacklogTest, StaysNearWhatWouldBeSentAtTheCostOfOneClassACall) {
  Random random(13);
  Counter bus;
  FakeWall wall;
  std::set<TrafficClass> tried;
  SenderOptions options = sharing(3000, wall);
  options.join = [&](std::span<const SendQueue::Next> together) {
    tried.insert(together.front().traffic);
    return share(together);
  };
  Sender sender(bus, nullptr, options);
  int64_t now_us = 0;
  int turns = 0;
  bool knows_both = false;  // each was tried, and waits
  for (int step = 0; step < 300; ++step) {
    const bool grows = step / 50 % 2 == 0;  // and shrinks
    for (uint64_t i = 1 + random.below(grows ? 120 : 20); i > 0; --i) {
      const TrafficClass traffic = random.below(2) == 0 ? TrafficClass::kBricks : TrafficClass::kCertainty;
      const std::string channel = "SHOAL_R00_" + std::to_string(static_cast<int>(traffic));
      const auto size = static_cast<size_t>(25 + 30 * (step / 50) % 90 + static_cast<int>(random.below(40)));
      sender.offer(traffic, channel + std::to_string(random.below(3000)),
                   packetWith(channel, size, random()));
    }
    for (const int64_t until_us = now_us + 1'000'000; now_us < until_us;)
      now_us = std::min(sender.pump(now_us), until_us);
    tried.clear();
    const int64_t published = sender.backlog();
    if (knows_both) {
      EXPECT_LE(tried.size(), 1u) << step;
    }
    const std::set<TrafficClass> first = std::exchange(tried, {});
    sender.backlog();
    turns += first.size() == 1 && tried.size() == 1 && first != tried;
    for (int again = 0; again < 2; ++again) sender.backlog();
    tried.clear();
    sender.backlog();
    EXPECT_TRUE(tried.empty()) << step;  // nothing has changed
    knows_both = sender.queue().numWaiting(TrafficClass::kBricks) > 0 &&
                 sender.queue().numWaiting(TrafficClass::kCertainty) > 0;
    if (step % 10 != 9) continue;
    Counter ideal;
    Sender drained(ideal, nullptr, sharing(0, wall));
    for (const TrafficClass traffic : {TrafficClass::kBricks, TrafficClass::kCertainty}) {
      for (const SendQueue::Next& next : sender.queue().waiting(traffic))
        drained.offer(traffic, next.key, *next.packet);
    }
    drained.pump(0);
    const auto sent = static_cast<int64_t>(drained.stats().linkBytes());
    EXPECT_LE(published * 4, sent * 5) << step;
    EXPECT_GE(published * 5, sent * 4) << step;
  }
  EXPECT_GT(turns, 0);  // the other class in the call after
}

TEST(BacklogTest, IsExactWhenLittleWaits) {
  for (size_t count = 1; count <= 40; ++count) {
    Counter bus;
    FakeWall wall;
    Sender sender(bus, nullptr, sharing(0, wall));
    for (size_t i = 0; i < count; ++i)
      sender.offer(TrafficClass::kBricks, std::to_string(100 + i), packetWith("B", 40 + 3 * i, i));
    const int64_t published = sender.backlog();
    sender.pump(0);
    if (bus.datagrams <= 4) {
      EXPECT_EQ(published, bus.bytes["B"]) << count;
    }
  }
}

// Of a class with something waiting, b bytes in all and a share f of the weights of the classes that never
// stop talking, the last byte has gone when b / f bytes have, and a datagram of every class; and of the
// budget B at least 0.4 carries content: 4/5 that heartbeats leave, 1/2 of a thin budget: budget.h.
TEST(BacklogTest, EveryClassDrainsHoweverMuchTheOthersHaveToSay) {
  const SendQueueOptions weights;
  const std::map<TrafficClass, int64_t> weight = {{TrafficClass::kMatches, weights.matches_weight},
                                                  {TrafficClass::kTopics, weights.topics_weight},
                                                  {TrafficClass::kBricks, weights.bricks_weight},
                                                  {TrafficClass::kCertainty, weights.certainty_weight},
                                                  {TrafficClass::kPictures, weights.pictures_weight},
                                                  {TrafficClass::kRequests, weights.requests_weight},
                                                  {TrafficClass::kRepairs, weights.repairs_weight}};
  double sum = 0;
  for (const auto& [traffic, each] : weight) sum += static_cast<double>(each);
  double slowest = 0;
  Random random(12);
  for (int trial = 0; trial < 140; ++trial) {
    const TrafficClass drained = kQueued[static_cast<size_t>(trial) % kQueued.size()];
    const int64_t budget = std::array{50, 200, 1000, 5000}[random.below(4)];
    Counter bus;
    FakeWall wall;
    SenderOptions options;
    options.bytes_per_s = budget;
    options.wall = wall.time();
    options.make_heartbeat = [](int64_t) { return packetWith("SHOAL_R00_HEARTBEAT", 80, 0); };
    Sender sender(bus, nullptr, options);
    int64_t now_us = 0;
    uint64_t n = 0;
    const auto offer = [&](TrafficClass traffic) {
      const std::string channel = "SHOAL_R00_" + std::to_string(static_cast<int>(traffic));
      sender.offer(traffic, channel + std::to_string(n), packetWith(channel, 20 + random.below(1300), n));
      ++n;
    };
    const auto othersTalk = [&] {
      for (const TrafficClass traffic : kQueued)
        while (traffic != drained && sender.queue().numWaiting(traffic) < 3) offer(traffic);
    };
    othersTalk();
    for (uint64_t i = random.below(40); i > 0; --i) {
      now_us = sender.pump(now_us);
      othersTalk();
    }
    for (uint64_t i = 1 + random.below(30); i > 0; --i) offer(drained);
    const int64_t began_us = now_us;
    const auto backlog = static_cast<double>(sender.queue().waitingBytes(drained));
    while (sender.queue().numWaiting(drained) > 0) {
      now_us = sender.pump(now_us);
      othersTalk();
    }
    const double bytes = backlog * sum / static_cast<double>(weight.at(drained)) +
                         static_cast<double>(kQueued.size() * kMaxWireBytes);
    const double factor = static_cast<double>(now_us - began_us) * 1e-6 * static_cast<double>(budget) / bytes;
    EXPECT_LT(factor, 2.5) << kTrafficClassNames[static_cast<size_t>(drained)] << " at " << budget << " B/s";
    slowest = std::max(slowest, factor);
  }
  EXPECT_GT(slowest, 1.0);  // the bound means something
  std::printf("slowest class: %.2f x its backlog / its share of the budget\n", slowest);
}

}  // namespace
}  // namespace shoal::comms
