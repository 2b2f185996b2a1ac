// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/surprise_scale.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "shoal/random.h"

namespace shoal::topics {
namespace {

// 1000 cells at 5 + i/64 bits, i = 0 to 99, ten of each: median 49/64 above 5, nine tenths below 90/64 above.
TEST(SurpriseScaleTest, CountsInTheUsualSpreadAboveTheMedian) {
  SurpriseScale scale;
  for (int i = 0; i < 1000; ++i) scale.add(5 + (i % 100) / 64.0);
  const std::vector<double> bits = {4, 5 + 49 / 64.0, 5 + 89 / 64.0, 5 + (49 + 80) / 64.0, 1000};
  const std::vector<float> told = scale.of(bits);
  EXPECT_EQ(told[0], 0);
  EXPECT_EQ(told[1], 0);
  EXPECT_EQ(told[2], 1);
  EXPECT_EQ(told[3], 2);
  EXPECT_GT(told[4], 90);
  EXPECT_TRUE(std::isfinite(told[4]));
}

TEST(SurpriseScaleTest, NothingIsUnusualToWhoHasSeenLittle) {
  SurpriseScale scale;
  for (int i = 0; i + 1 < SurpriseScale::kFewestCells; ++i) scale.add(i % 7);
  EXPECT_EQ(scale.of(std::vector<double>{50}), std::vector<float>{0});
  scale.add(3);
  EXPECT_GT(scale.of(std::vector<double>{50})[0], 1);
}

// One cell in ten is above 1, whatever the distribution.
TEST(SurpriseScaleTest, OneCellInTenExceedsOne) {
  for (const uint64_t seed : {1, 2, 3}) {
    Random random(seed);
    SurpriseScale scale;
    std::vector<double> bits;
    for (int i = 0; i < 20000; ++i)
      bits.push_back(3 - std::log(1 - random.uniform()) * static_cast<double>(seed));
    for (const double b : bits) scale.add(b);
    const std::vector<float> told = scale.of(bits);
    const auto above = static_cast<double>(std::ranges::count_if(told, [](float s) { return s > 1; }));
    EXPECT_NEAR(above / 20000, 0.1, 0.012);  // a step of 1/64 holds up to .008
  }
}

TEST(SurpriseScaleTest, GoesOnFromItsCounts) {
  SurpriseScale scale, again;
  for (int i = 0; i < 500; ++i) scale.add(i % 9);
  ASSERT_TRUE(again.restore(scale.counts()));
  const std::vector<double> bits = {2, 8, 9, 20};
  EXPECT_EQ(again.of(bits), scale.of(bits));
  EXPECT_FALSE(again.restore({3, -1, 2}));
  EXPECT_FALSE(again.restore({3, 0}));
  EXPECT_FALSE(again.restore(std::vector<int32_t>(5000, 1)));
  EXPECT_EQ(again.of(bits), scale.of(bits));
}

}  // namespace
}  // namespace shoal::topics
