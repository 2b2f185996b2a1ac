// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/fixed_log.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shoal/random.h"

namespace shoal::matching {
namespace {

constexpr double kUnit = 0x1p-40;

TEST(FixedLog2Test, IsExactForPowersOfTwo) {
  for (int k = 0; k <= 62; ++k) EXPECT_EQ(fixedLog2(int64_t{1} << k), int64_t{k} << kLogBits);
}

TEST(FixedLog2Test, IsTheLogarithmWithinFourUnits) {
  Random random(1);
  for (int trial = 0; trial < 20000; ++trial) {
    const auto x = static_cast<int64_t>(1 + random() % (uint64_t{1} << (1 + trial % 52)));
    EXPECT_NEAR(static_cast<double>(fixedLog2(x)) * kUnit, std::log2(static_cast<double>(x)), 4 * kUnit) << x;
  }
}

TEST(FixedLog2Test, AddsOneForEveryDoublingAndNeverFalls) {
  Random random(2);
  for (int trial = 0; trial < 1000; ++trial) {
    const auto x = static_cast<int64_t>(1 + random() % (uint64_t{1} << 60));
    EXPECT_EQ(fixedLog2(2 * x), fixedLog2(x) + (int64_t{1} << kLogBits));
    EXPECT_LE(fixedLog2(x), fixedLog2(x + 1));
  }
}

}  // namespace
}  // namespace shoal::matching
