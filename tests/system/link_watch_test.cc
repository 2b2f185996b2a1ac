// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/link_watch.h"

#include <gtest/gtest.h>

#include "shoal/random.h"

namespace shoal::fusion_node {
namespace {

// A node that says 5 messages of 100 bytes and a heartbeat of 200 each second; each arrives with a chance.
class Talk {
 public:
  explicit Talk(double arrives, uint64_t seed = 1) : arrives_(arrives), random_(seed) {}

  void second(LinkWatch& watch) {
    time_us_ += 1'000'000;
    for (int i = 0; i < 5; ++i) say(watch, 100);
    wire::Heartbeat beat;
    beat.time.us = time_us_;
    beat.pid = pid;
    beat.bytes_sent = sent;  // the heartbeat itself is not in it yet
    sent += 200;
    if (!arrive()) return;
    watch.claimed("R00", beat);
    watch.heard("R00", 200);
  }

  int32_t pid = 1;
  int64_t sent = 0;

 private:
  bool arrive() { return random_.uniform() < arrives_; }
  void say(LinkWatch& watch, int64_t bytes) {
    sent += bytes;
    if (arrive()) watch.heard("R00", static_cast<size_t>(bytes));
  }

  const double arrives_;
  Random random_;
  int64_t time_us_ = 0;
};

TEST(LinkWatchTest, WhatAllArrivesIsOneAndWhatIsUnknownIsNothing) {
  LinkWatch watch;
  Talk talk(1.0);
  EXPECT_FALSE(watch.shareOf("R00"));
  for (int i = 0; i < 2; ++i) talk.second(watch);
  EXPECT_FALSE(watch.shareOf("R00"));
  for (int i = 0; i < 200; ++i) {
    talk.second(watch);
    ASSERT_EQ(watch.shareOf("R00"), 1.0) << i;
  }
  EXPECT_FALSE(watch.shareOf("R01"));
}

TEST(LinkWatchTest, LossIsSeenOverTheLastMinute) {
  for (const double arrives : {0.9, 0.5}) {
    double mean = 0.0;
    for (uint64_t seed = 0; seed < 50; ++seed) {
      LinkWatch watch;
      Talk talk(arrives, seed);
      for (int i = 0; i < 120; ++i) talk.second(watch);
      ASSERT_TRUE(watch.shareOf("R00"));
      EXPECT_NEAR(*watch.shareOf("R00"), arrives, 0.15);
      mean += *watch.shareOf("R00") / 50;
    }
    EXPECT_NEAR(mean, arrives, 0.02);
  }
}

TEST(LinkWatchTest, ALinkThatRecoversIsGoodAfterAMinute) {
  LinkWatch watch;
  Talk talk(1.0);
  for (int i = 0; i < 10; ++i) talk.second(watch);
  talk.sent += 6000;  // lost
  talk.second(watch);
  EXPECT_LT(*watch.shareOf("R00"), 0.7);
  for (int i = 0; i < 70; ++i) talk.second(watch);
  EXPECT_EQ(watch.shareOf("R00"), 1.0);
}

// Hand sums: 1000 bytes were said before the heartbeat, 700 of them heard; the rest comes late.
TEST(LinkWatchTest, WhatWasMissedIsWhatWasSaidAndNotHeard) {
  LinkWatch watch;
  EXPECT_FALSE(watch.missedOf("R00"));
  wire::Heartbeat beat;
  beat.pid = 1;
  watch.claimed("R00", beat);
  EXPECT_EQ(watch.missedOf("R00"), 0);
  watch.heard("R00", 700);
  EXPECT_EQ(watch.missedOf("R00"), 0);  // what was heard since is not missed yet, nor is anything found
  beat.time.us = 1'000'000;
  beat.bytes_sent = 1000;
  watch.claimed("R00", beat);
  EXPECT_EQ(watch.missedOf("R00"), 300);
  watch.heard("R00", 300 + 200);  // the late bytes, and the heartbeat itself
  beat.time.us = 2'000'000;
  beat.bytes_sent = 1200;
  watch.claimed("R00", beat);
  EXPECT_EQ(watch.missedOf("R00"), 0);
  beat.pid = 2;  // another process; its first message was not heard
  beat.time.us = 3'000'000;
  beat.bytes_sent = 50;
  watch.claimed("R00", beat);
  EXPECT_EQ(watch.missedOf("R00"), 50);
}

TEST(LinkWatchTest, ANewProcessCountsFromNothing) {
  LinkWatch watch;
  Talk talk(1.0);
  for (int i = 0; i < 10; ++i) talk.second(watch);
  talk.pid = 2;
  talk.sent = 0;
  talk.second(watch);
  EXPECT_FALSE(watch.shareOf("R00"));
  for (int i = 0; i < 5; ++i) talk.second(watch);
  EXPECT_EQ(watch.shareOf("R00"), 1.0);
}

TEST(LinkWatchTest, LateAndCraftedHeartbeatsHurtNobody) {
  LinkWatch watch;
  Talk talk(1.0);
  for (int i = 0; i < 10; ++i) talk.second(watch);
  wire::Heartbeat late;
  late.time.us = 3'000'000;
  late.pid = 1;
  late.bytes_sent = 1400;
  watch.claimed("R00", late);
  EXPECT_EQ(watch.shareOf("R00"), 1.0);
  for (size_t i = 0; i < 2 * LinkWatch::kMaxNames; ++i) {
    watch.claimed("N" + std::to_string(i), late);
    watch.heard("N" + std::to_string(i), 1000);
  }
  late.time.us = INT64_MAX / 2;
  late.bytes_sent = INT64_MAX;
  watch.claimed("R00", late);
  EXPECT_NEAR(*watch.shareOf("R00"), 0.0, 1e-9);
}

}  // namespace
}  // namespace shoal::fusion_node
