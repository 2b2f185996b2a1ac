// SPDX-License-Identifier: BSD-3-Clause
// Packets that wait share datagrams.
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "fake_wall.h"
#include "shoal/comms/sender.h"

namespace shoal::comms {
namespace {

class Recorder : public Bus {
 public:
  void publish(const Packet& packet) override { sent.push_back(packet); }
  int receive(int, const std::function<void(const Packet&)>&) override { return 0; }
  std::vector<Packet> sent;
};

// Bytes one after the other.
std::optional<Packet> concatenate(std::span<const SendQueue::Next> together) {
  Packet all{together.front().packet->channel, {}};
  for (const SendQueue::Next& next : together)
    all.bytes.insert(all.bytes.end(), next.packet->bytes.begin(), next.packet->bytes.end());
  return all;
}

SenderOptions options(int64_t bytes_per_s, size_t most) {
  SenderOptions sender;
  sender.bytes_per_s = bytes_per_s;
  sender.wall = FakeWall().time();
  sender.join = concatenate;
  sender.most_joined_bytes = most;
  return sender;
}

Packet packet(char letter, size_t size, const std::string& channel = "C") {
  return {channel, Bytes(size, static_cast<uint8_t>(letter))};
}

TEST(JoiningTest, FillsDatagramsAndSaysEverythingOnce) {
  for (const int count : {1, 2, 3, 7, 50}) {
    Recorder bus;
    Sender sender(bus, nullptr, options(0, 100));
    for (int i = 0; i < count; ++i)
      sender.offer(TrafficClass::kBricks, std::to_string(100 + i), packet(static_cast<char>(i), 9));
    sender.pump(0);
    std::multiset<uint8_t> said;
    for (const Packet& each : bus.sent) said.insert(each.bytes.begin(), each.bytes.end());
    for (int i = 0; i < count; ++i) EXPECT_EQ(said.count(static_cast<uint8_t>(i)), 9u);
    EXPECT_EQ(bus.sent.size(), static_cast<size_t>((count + 10) / 11));  // 11 x 9 bytes fit into 100
    EXPECT_EQ(sender.queue().waitingBytes(), 0);
  }
}

TEST(JoiningTest, KeepsClassesAndChannelsApart) {
  Recorder bus;
  Sender sender(bus, nullptr, options(0, 100));
  sender.offer(TrafficClass::kBricks, "1", packet('a', 5, "A"));
  sender.offer(TrafficClass::kBricks, "2", packet('b', 5, "B"));
  sender.offer(TrafficClass::kBricks, "3", packet('c', 5, "A"));
  sender.offer(TrafficClass::kCertainty, "4", packet('d', 5, "A"));
  sender.pump(0);
  std::multiset<std::string> said;
  for (const Packet& each : bus.sent)
    said.insert(each.channel + std::string(each.bytes.begin(), each.bytes.end()));
  EXPECT_EQ(said, (std::multiset<std::string>{"Aaaaaaccccc", "Bbbbbb", "Addddd"}));
}

// What was made waits for the budget; what changes meanwhile goes out as it is then.
TEST(JoiningTest, WaitsForTheBudgetWithTheNewestContent) {
  Recorder bus;
  Sender sender(bus, nullptr, options(200, 100));
  for (int i = 0; i < 30; ++i) sender.offer(TrafficClass::kBricks, std::to_string(100 + i), packet('o', 9));
  int64_t next = sender.pump(0);
  const size_t at_once = bus.sent.size();
  EXPECT_GE(at_once, 1u);
  EXPECT_LT(at_once, 3u);
  for (int i = 0; i < 30; ++i) sender.offer(TrafficClass::kBricks, std::to_string(100 + i), packet('n', 9));
  while (sender.queue().waitingBytes() > 0) next = sender.pump(next);
  size_t new_bytes = 0;
  for (size_t i = at_once; i < bus.sent.size(); ++i)
    for (const uint8_t byte : bus.sent[i].bytes) new_bytes += byte == 'n' ? 1 : 0;
  EXPECT_EQ(new_bytes, 30u * 9);
  EXPECT_LE(sender.worstWindow().bytes, sender.worstWindow().budget);
}

TEST(JoiningTest, RepeatsTogetherToo) {
  Recorder bus;
  SenderOptions sending = options(0, 100);
  sending.queue.min_resend_interval_us = 1'000'000;
  sending.queue.max_resends = 3;
  Sender sender(bus, nullptr, sending);
  for (int i = 0; i < 20; ++i) sender.offer(TrafficClass::kBricks, std::to_string(100 + i), packet('x', 9));
  sender.pump(0);
  EXPECT_EQ(bus.sent.size(), 2u);
  sender.pump(1'000'000);
  EXPECT_EQ(bus.sent.size(), 4u);
}

}  // namespace
}  // namespace shoal::comms
