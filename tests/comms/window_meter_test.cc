// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/window_meter.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "second.h"
#include "shoal/random.h"

namespace shoal::comms {
namespace {

TEST(WindowMeterTest, MeasuresWindowsWorkedByHand) {
  WindowMeter meter(100);
  EXPECT_EQ(meter.worst().share, 0);
  meter.add(0, 40);
  EXPECT_DOUBLE_EQ(meter.worst().share, 0.4);
  meter.add(2 * kSecond, 140);  // 180 bytes in 2 s, 140 bytes alone: full, not over
  EXPECT_DOUBLE_EQ(meter.worst().share, 1.0);
  EXPECT_EQ(meter.worst().datagrams, 1u);
  meter.add(2'500'000, 1);  // no longer alone: 141 bytes in 1 s
  EXPECT_DOUBLE_EQ(meter.worst().share, 1.41);
  EXPECT_FALSE(meter.worst().within_budget);
  EXPECT_EQ(meter.worst().start_us, 2 * kSecond);
  EXPECT_EQ(meter.worst().length_us, kSecond);
}

TEST(WindowMeterTest, DecidesByTheByte) {
  WindowMeter full(3);
  full.add(0, 2);
  full.add(1'333'334, 2);
  EXPECT_TRUE(full.worst().within_budget);
  WindowMeter over(3);
  over.add(0, 2);
  over.add(1'333'333, 2);
  EXPECT_FALSE(over.worst().within_budget);
}

TEST(WindowMeterTest, TakesDatagramsInAnyOrder) {
  WindowMeter meter(0);
  meter.add(3 * kSecond, 10);
  meter.add(0, 10);
  meter.add(kSecond, 10);
  EXPECT_EQ(meter.worst().bytes, 20);  // 20 bytes in [0, 1 s] beat 30 in 3 s
  EXPECT_TRUE(meter.worst().within_budget);
}

// Long windows matter when lone datagrams fill more than a second, so budgets here are small and large.
TEST(WindowMeterTest, AgreesWithBruteForceOverAllWindows) {
  for (uint64_t trial = 0; trial < 300; ++trial) {
    SCOPED_TRACE(trial);
    Random random(4, trial);
    const auto bytes_per_s = static_cast<int64_t>(1 + random.below(3000));
    const uint64_t longest_pause = trial % 2 == 0 ? 3'000'000 : 400'000;
    WindowMeter meter(bytes_per_s);
    std::vector<int64_t> times;
    std::vector<int64_t> sizes;
    int64_t now_us = 0;
    for (uint64_t n = 0; n < 1 + trial % 60; ++n) {
      if (random.below(5) != 0) now_us += static_cast<int64_t>(random.below(longest_pause));
      times.push_back(now_us);
      sizes.push_back(static_cast<int64_t>(1 + random.below(1500)));
      meter.add(now_us, static_cast<size_t>(sizes.back()));
    }
    std::vector<int64_t> from_us(1 + trial % 4);
    for (int64_t& from : from_us)
      from = static_cast<int64_t>(random.below(static_cast<uint64_t>(now_us) + 1));
    std::ranges::sort(from_us);
    double worst = 0;
    std::vector<double> worst_of(from_us.size());
    for (size_t i = 0; i < times.size(); ++i) {
      int64_t bytes = 0;
      for (size_t j = i; j < times.size(); ++j) {
        bytes += sizes[j];
        const auto length_us = static_cast<double>(std::max(kSecond, times[j] - times[i]));
        double share = static_cast<double>(bytes) * 1e6 / (static_cast<double>(bytes_per_s) * length_us);
        if (i == j) share = std::min(share, 1.0);
        worst = std::max(worst, share);
        const auto stretch = std::ranges::upper_bound(from_us, times[j]) - from_us.begin();
        if (stretch == 0) continue;
        double& worst_here = worst_of[static_cast<size_t>(stretch - 1)];
        worst_here = std::max(worst_here, share);
      }
    }
    EXPECT_NEAR(meter.worst().share, worst, 1e-9 * worst);
    EXPECT_EQ(meter.worst().within_budget, worst <= 1.0);
    const std::vector<MeteredWindow> windows = meter.worstEndingIn(from_us);
    ASSERT_EQ(windows.size(), from_us.size());
    for (size_t i = 0; i < windows.size(); ++i)
      EXPECT_NEAR(windows[i].share, worst_of[i], 1e-9 * worst_of[i]);
  }
}

TEST(WindowMeterTest, RejectsANegativeBudget) { EXPECT_THROW(WindowMeter(-1), std::invalid_argument); }

}  // namespace
}  // namespace shoal::comms
