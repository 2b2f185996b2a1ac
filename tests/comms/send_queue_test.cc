// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/send_queue.h"

#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "shoal/random.h"

namespace shoal::comms {
namespace {

Packet packetOf(const std::string& text, size_t size = 0) {
  Packet made{"SHOAL_R00_TOPICS", Bytes(text.begin(), text.end())};
  if (size > 0) made.bytes.resize(size);
  return made;
}

std::string text(const Packet& packet) { return {packet.bytes.begin(), packet.bytes.end()}; }

// Sends what is due at now_us and says what it was; "" for nothing.
std::string take(SendQueue& queue, int64_t now_us = 0) {
  const auto next = queue.next(now_us);
  if (!next) return "";
  std::string taken = text(*next->packet) + (next->resent ? " again" : "");
  queue.markSent(now_us);
  return taken;
}

TEST(SendQueueTest, SendsInsideAClassInTheOrderOfTheFirstOffer) {
  SendQueue queue;
  queue.offer(TrafficClass::kBricks, "z", packetOf("z1"));
  queue.offer(TrafficClass::kBricks, "a", packetOf("a1"));
  queue.offer(TrafficClass::kBricks, "m", packetOf("m1"));
  queue.offer(TrafficClass::kBricks, "z", packetOf("z2"));  // keeps the place
  EXPECT_EQ(queue.numWaiting(TrafficClass::kBricks), 3u);
  EXPECT_EQ(take(queue), "z2");
  EXPECT_EQ(take(queue), "a1");
  EXPECT_EQ(take(queue), "m1");
  EXPECT_EQ(take(queue), "");
}

TEST(SendQueueTest, UtilityGoesFirstWhenAllIsNew) {
  SendQueue queue;
  queue.offer(TrafficClass::kCertainty, "c", packetOf("c"));
  queue.offer(TrafficClass::kBricks, "b", packetOf("b"));
  queue.offer(TrafficClass::kTopics, "t", packetOf("t"));
  queue.offer(TrafficClass::kMatches, "m", packetOf("m"));
  EXPECT_EQ(take(queue), "m");
  EXPECT_EQ(take(queue), "t");
  EXPECT_EQ(take(queue), "b");
  EXPECT_EQ(take(queue), "c");
}

TEST(SendQueueTest, SharesTheBytesByWeightAndStarvesNobody) {
  SendQueue queue;
  const std::vector<TrafficClass> classes = {TrafficClass::kMatches, TrafficClass::kTopics,
                                             TrafficClass::kBricks, TrafficClass::kCertainty};
  Random random(5);
  uint64_t n = 0;
  std::map<TrafficClass, double> bytes;
  double total = 0;
  for (int i = 0; i < 4000; ++i) {
    for (const TrafficClass traffic : classes) {  // always something new in each
      while (queue.numWaiting(traffic) < 2) {
        const std::string key = std::to_string(n++);
        queue.offer(traffic, key, packetOf(key, 100 + random.below(1200)));
      }
    }
    const auto next = queue.next(0);
    bytes[next->traffic] += static_cast<double>(wireSize(*next->packet));
    total += static_cast<double>(wireSize(*next->packet));
    queue.markSent(0);
  }
  EXPECT_NEAR(bytes[TrafficClass::kMatches] / total, 8. / 21, 0.01);
  EXPECT_NEAR(bytes[TrafficClass::kTopics] / total, 8. / 21, 0.01);
  EXPECT_NEAR(bytes[TrafficClass::kBricks] / total, 4. / 21, 0.01);
  EXPECT_NEAR(bytes[TrafficClass::kCertainty] / total, 1. / 21, 0.01);
}

// Topics alone are busy for long; matches that come then do not get the link for as long.
TEST(SendQueueTest, AnIdleClassSavesNothingUp) {
  SendQueue queue;
  for (int i = 0; i < 100; ++i)
    queue.offer(TrafficClass::kTopics, "t" + std::to_string(i), packetOf("t" + std::to_string(i)));
  for (int i = 0; i < 50; ++i) take(queue);
  for (int i = 0; i < 50; ++i)
    queue.offer(TrafficClass::kMatches, "m" + std::to_string(i), packetOf("m" + std::to_string(i)));
  int topics = 0;
  for (int i = 0; i < 20; ++i) topics += take(queue).starts_with("t") ? 1 : 0;
  EXPECT_NEAR(topics, 10, 1);
}

TEST(SendQueueTest, SendsEverythingAgainRoundAndRoundWhenNothingNewWaits) {
  SendQueue queue({.min_resend_interval_us = 1, .max_resends = 1000});
  for (const char* key : {"a", "b", "c"}) queue.offer(TrafficClass::kTopics, key, packetOf(key));
  std::string sent;
  for (int now_us = 0; now_us < 9; ++now_us) sent += take(queue, now_us) + ",";
  EXPECT_EQ(sent, "a,b,c,a again,b again,c again,a again,b again,c again,");
}

TEST(SendQueueTest, NewContentInterruptsTheRotation) {
  SendQueue queue({.min_resend_interval_us = 1, .max_resends = 1000});
  for (const char* key : {"a", "b", "c"}) queue.offer(TrafficClass::kTopics, key, packetOf(key));
  for (int i = 0; i < 4; ++i) take(queue, i);
  queue.offer(TrafficClass::kCertainty, "new", packetOf("new"));
  queue.offer(TrafficClass::kTopics, "b", packetOf("b2"));
  EXPECT_EQ(queue.waitingBytes(), static_cast<int64_t>(wireSize(packetOf("new")) + wireSize(packetOf("b2"))));
  std::string sent;
  for (int i = 4; i < 10; ++i) sent += take(queue, i) + ",";
  EXPECT_EQ(sent, "b2,new,c again,a again,b2 again,new again,");
}

TEST(SendQueueTest, SendsNothingAgainTooSoon) {
  SendQueue queue({.min_resend_interval_us = 1000, .max_resends = 1000});
  EXPECT_EQ(queue.nextResend(), std::nullopt);
  queue.offer(TrafficClass::kTopics, "a", packetOf("a"));
  EXPECT_EQ(take(queue, 50), "a");
  EXPECT_EQ(queue.nextResend(), 1050);
  EXPECT_EQ(take(queue, 1049), "");
  EXPECT_EQ(take(queue, 1050), "a again");
}

TEST(SendQueueTest, TheSameContentIsNotNew) {
  SendQueue queue;
  queue.offer(TrafficClass::kTopics, "a", packetOf("a"));
  take(queue);
  queue.offer(TrafficClass::kTopics, "a", packetOf("a"));
  EXPECT_EQ(queue.numWaiting(TrafficClass::kTopics), 0u);
  EXPECT_EQ(take(queue), "");
}

TEST(SendQueueTest, ForgetsWaitingAndSentContent) {
  SendQueue queue({.min_resend_interval_us = 1, .max_resends = 1000});
  queue.offer(TrafficClass::kTopics, "a", packetOf("a"));
  take(queue);
  queue.offer(TrafficClass::kTopics, "b", packetOf("b"));
  queue.forget("a");
  queue.forget("b");
  queue.forget("never there");
  EXPECT_EQ(take(queue, 100), "");
  EXPECT_EQ(queue.numKeys(), 0u);
  EXPECT_EQ(queue.waitingBytes(), 0);
}

TEST(SendQueueTest, CountsWhatWaitsExactly) {
  SendQueue queue({.min_resend_interval_us = 1, .max_resends = 1000});
  Random random(6);
  std::map<std::string, std::pair<TrafficClass, size_t>> waiting;  // the definition
  for (int i = 0; i < 3000; ++i) {
    const uint64_t k = random.below(20);
    const std::string key = std::to_string(k);
    switch (random.below(5)) {
      case 0:
        queue.forget(key);
        waiting.erase(key);
        break;
      case 1: {
        const auto next = queue.next(i);
        if (!next) break;
        if (!next->resent) waiting.erase(std::string(next->key));
        queue.markSent(i);
        break;
      }
      default: {
        const auto traffic = static_cast<TrafficClass>(1 + k % 4);
        const Packet content = packetOf(std::to_string(i), 10 + random.below(100));
        queue.offer(traffic, key, content);
        waiting[key] = {traffic, wireSize(content)};
      }
    }
    std::map<TrafficClass, int64_t> bytes;
    for (const auto& [name, what] : waiting) bytes[what.first] += static_cast<int64_t>(what.second);
    int64_t total = 0;
    for (int c = 1; c <= 4; ++c) {
      const auto traffic = static_cast<TrafficClass>(c);
      ASSERT_EQ(queue.waitingBytes(traffic), bytes[traffic]);
      total += bytes[traffic];
    }
    ASSERT_EQ(queue.waitingBytes(), total);
  }
}

TEST(SendQueueTest, RejectsWhatItCannotQueue) {
  SendQueue queue;
  EXPECT_THROW(queue.offer(TrafficClass::kHeartbeat, "a", packetOf("a")), std::invalid_argument);
  EXPECT_THROW(queue.offer(TrafficClass::kLocal, "a", packetOf("a")), std::invalid_argument);
  const size_t fits = kMaxMessageBytes - 8 - 16 - 1;  // the channel has 16 letters
  queue.offer(TrafficClass::kTopics, "a", packetOf("a", fits));
  EXPECT_THROW(queue.offer(TrafficClass::kTopics, "b", packetOf("b", fits + 1)), std::invalid_argument);
  EXPECT_THROW(queue.offer(TrafficClass::kBricks, "a", packetOf("a")), std::invalid_argument);
  EXPECT_THROW(SendQueue({.bricks_weight = 0}), std::invalid_argument);
  EXPECT_THROW(SendQueue({.min_resend_interval_us = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace shoal::comms
