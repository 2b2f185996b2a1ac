// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/budget.h"

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "second.h"
#include "shoal/comms/packet.h"
#include "shoal/comms/window_meter.h"
#include "shoal/random.h"

namespace shoal::comms {
namespace {

struct Sent {
  int64_t at_us;
  int64_t bytes;
};

// The definition: every window of two or more datagrams, one by one.
bool allWindowsInBudget(const std::vector<Sent>& sent, int64_t bytes_per_s) {
  for (size_t i = 0; i < sent.size(); ++i) {
    int64_t bytes = sent[i].bytes;
    for (size_t j = i + 1; j < sent.size(); ++j) {
      bytes += sent[j].bytes;
      const int64_t length_us = std::max(kSecond, sent[j].at_us - sent[i].at_us);
      if (bytes * kSecond > bytes_per_s * length_us) return false;
    }
  }
  return true;
}

TEST(BudgetTest, LetsOneSecondsWorthOutAtOnceAndThenTheRate) {
  Budget budget(1000);
  for (int i = 0; i < 10; ++i) {
    ASSERT_EQ(budget.earliest(0, 100), 0);
    budget.spend(0, 100);
  }
  // By hand: 1100 bytes since 0 need 1.1 s, 1200 bytes 1.2 s.
  EXPECT_EQ(budget.earliest(0, 100), 1'100'000);
  budget.spend(1'100'000, 100);
  EXPECT_EQ(budget.earliest(1'100'000, 100), 1'200'000);
  EXPECT_EQ(budget.earliest(1'500'000, 100), 1'500'000);
}

TEST(BudgetTest, AllowsADatagramAboveTheBudgetWhenItStandsAlone) {
  Budget budget(1000);
  EXPECT_EQ(budget.earliest(5, 1428), 5);
  budget.spend(5, 1428);
  EXPECT_EQ(budget.earliest(5, 1428), 5 + 2'856'000);  // two of them need 2.856 s
  EXPECT_EQ(budget.earliest(5, 1), 5 + 1'429'000);
  EXPECT_EQ(budget.worst().bytes, 1428);
  EXPECT_EQ(budget.worst().budget, 1428);
}

TEST(BudgetTest, RoundsUpToTheMicrosecond) {
  Budget budget(3);
  budget.spend(0, 3);
  EXPECT_EQ(budget.earliest(0, 1), 1'333'334);  // 4/3 s
}

TEST(BudgetTest, WithoutALimitAlwaysSaysNow) {
  Budget budget(0);
  for (int i = 0; i < 1000; ++i) budget.spend(7, 1400);
  EXPECT_EQ(budget.earliest(7, 1400), 7);
  EXPECT_EQ(budget.worst().bytes, 1'400'000);
  EXPECT_EQ(budget.worst().budget, 0);
}

TEST(BudgetTest, NeverExceedsAnyWindowAndIsNeverLaterThanTheDefinitionDemands) {
  for (uint64_t trial = 0; trial < 120; ++trial) {
    SCOPED_TRACE(trial);
    Random random(1, trial);
    const auto bytes_per_s =
        static_cast<int64_t>(trial % 3 == 0 ? 1 + random.below(500) : 200 + random.below(4000));
    const uint64_t largest = 1 + random.below(1500);
    const uint64_t longest_pause = random.below(3) == 0 ? 5'000'000 : 1 + random.below(300'000);
    Budget budget(bytes_per_s);
    WindowMeter meter(bytes_per_s);
    std::vector<Sent> sent;
    int64_t now_us = -static_cast<int64_t>(random.below(10'000'000));
    for (int n = 0; n < 150; ++n) {
      now_us += static_cast<int64_t>(random.below(longest_pause));
      const auto bytes = static_cast<int64_t>(1 + random.below(largest));
      const int64_t at_us = budget.earliest(now_us, static_cast<size_t>(bytes));
      ASSERT_GE(at_us, now_us);
      if (at_us > now_us) {  // a microsecond earlier would break some window
        std::vector<Sent> early = sent;
        early.push_back({at_us - 1, bytes});
        ASSERT_FALSE(allWindowsInBudget(early, bytes_per_s)) << n;
      }
      if (random.below(4) == 0) continue;  // asked, not sent
      budget.spend(at_us, static_cast<size_t>(bytes));
      meter.add(at_us, static_cast<size_t>(bytes));
      sent.push_back({at_us, bytes});
      now_us = at_us;
    }
    EXPECT_TRUE(allWindowsInBudget(sent, bytes_per_s));
    EXPECT_TRUE(meter.worst().within_budget);
    EXPECT_LE(budget.worst().bytes, budget.worst().budget);
  }
}

// What a sender that always has something to send gets through.
double shareOfBudget(int64_t bytes_per_s, int64_t seconds, const std::function<size_t()>& next_size) {
  Budget budget(bytes_per_s);
  int64_t sent = 0;
  for (int64_t now_us = 0;;) {
    const size_t bytes = next_size();
    now_us = budget.earliest(now_us, bytes);
    if (now_us > seconds * kSecond) break;
    budget.spend(now_us, bytes);
    sent += static_cast<int64_t>(bytes);
  }
  return static_cast<double>(sent) / static_cast<double>(bytes_per_s * seconds);
}

TEST(BudgetTest, AGreedySenderOfSmallDatagramsUsesNearlyAllOfIt) {
  for (const int64_t bytes_per_s : {4000, 30000, 1'000'000}) {
    Random random(2, static_cast<uint64_t>(bytes_per_s));
    const uint64_t largest = std::min<uint64_t>(1428, static_cast<uint64_t>(bytes_per_s) / 21);
    const double share = shareOfBudget(bytes_per_s, bytes_per_s > 100'000 ? 20 : 1000,
                                       [&] { return 40 + random.below(largest - 39); });
    RecordProperty("share_at_" + std::to_string(bytes_per_s), std::to_string(share));
    EXPECT_GT(share, 0.95) << bytes_per_s;
    EXPECT_LE(share, 1.0) << bytes_per_s;
  }
}

// k + 1 equal datagrams are above a second's worth, so they span (k + 1) s / B, in k gaps: k / (k + 1) is the
// most that the contract allows anybody.
TEST(BudgetTest, AGreedySenderOfLargeDatagramsUsesAllThatTheWindowsAllow) {
  for (const int64_t bytes_per_s : {100, 999, 2000, 5000, 20000}) {
    for (const size_t bytes : {200u, 500u, 1000u, 1428u}) {
      const auto fit = static_cast<double>(std::max<int64_t>(1, bytes_per_s / static_cast<int64_t>(bytes)));
      const double share = shareOfBudget(bytes_per_s, 2000, [&] { return bytes; });
      EXPECT_NEAR(share, fit / (fit + 1), 0.01) << bytes_per_s << " B/s, " << bytes << " B";
    }
  }
}

TEST(BudgetTest, RecommendsDatagramsThatCarryMost) {
  EXPECT_EQ(efficientDatagram(0, 75), kMaxWireBytes);
  EXPECT_EQ(efficientDatagram(1'000'000, 75), kMaxWireBytes);
  EXPECT_EQ(efficientDatagram(100, 75), kMaxWireBytes);  // half the budget either way: the least overhead
  // By hand, 2000 B/s: 500 B carry .85 x 4/5 = .68, 400 B .8125 x 5/6 = .677, 666 B .887 x 3/4 = .666, 1428 B
  // .47.
  EXPECT_EQ(efficientDatagram(2000, 75), 500u);
}

TEST(BudgetTest, TheWorstSecondMatchesBruteForce) {
  for (const int64_t bytes_per_s : {0, 900}) {
    Random random(3);
    Budget budget(bytes_per_s);
    std::vector<Sent> sent;
    int64_t now_us = 0;
    for (int n = 0; n < 400; ++n) {
      const auto bytes = static_cast<size_t>(1 + random.below(600));
      now_us = budget.earliest(now_us + static_cast<int64_t>(random.below(500'000)), bytes);
      budget.spend(now_us, bytes);
      sent.push_back({now_us, static_cast<int64_t>(bytes)});
    }
    int64_t worst = 0;
    for (const Sent& first : sent) {
      int64_t bytes = 0;
      for (const Sent& each : sent) {
        if (each.at_us >= first.at_us && each.at_us <= first.at_us + kSecond) bytes += each.bytes;
      }
      worst = std::max(worst, bytes);
    }
    EXPECT_EQ(budget.worst().bytes, worst);
  }
}

TEST(BudgetTest, ASecondIncludesBothOfItsEnds) {
  Budget budget(0);
  budget.spend(0, 10);
  budget.spend(kSecond, 10);
  EXPECT_EQ(budget.worst().bytes, 20);
  budget.spend(2 * kSecond + 1, 15);
  EXPECT_EQ(budget.worst().bytes, 20);
}

TEST(BudgetTest, AfterACrashSupposesTheBudgetWasUsedUp) {
  for (const size_t largest : {500u, 1428u}) {
    // What the process did before: as much as possible in the last moment.
    Budget budget(1000);
    budget.assumeExhausted(10 * kSecond, largest);
    const int64_t before = std::max<int64_t>(1000, static_cast<int64_t>(largest));
    EXPECT_EQ(budget.earliest(10 * kSecond, 100), 10 * kSecond + (before + 100) * 1000);
    EXPECT_EQ(budget.worst().bytes, 0);
  }
}

TEST(BudgetTest, ClampsTimeThatRunsBackwards) {
  Budget budget(1000);
  budget.spend(5 * kSecond, 400);
  EXPECT_EQ(budget.earliest(kSecond, 400), 5 * kSecond);
}

TEST(BudgetTest, RejectsWhatIsNoBudget) {
  EXPECT_THROW(Budget(-1), std::invalid_argument);
  EXPECT_THROW(Budget(1'000'000'000'001), std::invalid_argument);
}

TEST(BudgetDeathTest, AbortsWhenMoreIsSpentThanAllowed) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  Budget budget(1000);
  budget.spend(0, 1000);
  EXPECT_DEATH(budget.spend(1'000'000, 1), "demand failed");
}

}  // namespace
}  // namespace shoal::comms
