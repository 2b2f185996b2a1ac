// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/fixed_log.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "shoal/random.h"

namespace shoal::topics {
namespace {

TEST(FixedLogTest, PowersOfTwoAreExact) {
  for (int power = 0; power < 64; ++power) {
    EXPECT_EQ(fixedLog2(uint64_t{1} << power), static_cast<uint32_t>(power) << kLogBits) << power;
  }
  for (int power = 0; power <= 32; ++power) {
    EXPECT_EQ(fixedExp2(power * kLogOne), uint64_t{1} << (32 - power)) << power;
  }
}

TEST(FixedLogTest, LogarithmsAreRoundedDown) {
  Random random(1);
  for (int i = 0; i < 20'000; ++i) {
    const uint64_t x = random() >> random.below(64);
    if (x == 0) continue;
    const double exact = std::log2(static_cast<double>(x)) * kLogOne;
    EXPECT_NEAR(static_cast<double>(fixedLog2(x)), exact - 0.5, 0.51) << x;
  }
}

TEST(FixedLogTest, LogarithmsNeverFall) {
  for (uint64_t x = 1; x < 70'000; ++x) ASSERT_LE(fixedLog2(x), fixedLog2(x + 1)) << x;
}

TEST(FixedLogTest, PowersAreOffByAFewUnits) {
  for (int64_t d = 0; d < 34 * kLogOne; d += 97) {
    const double exact = std::exp2(32.0 - static_cast<double>(d) / kLogOne);
    EXPECT_NEAR(static_cast<double>(fixedExp2(d)), exact - 8.0, 9.0) << d;
  }
}

TEST(FixedLogTest, WhatIsTooSmallIsZero) {
  EXPECT_EQ(fixedExp2(33 * kLogOne), 0u);
  EXPECT_EQ(fixedExp2(int64_t{1} << 60), 0u);
}

// They are also known to the compiler.
static_assert(fixedLog2(256) == 8 << kLogBits);
static_assert(fixedExp2(kLogOne) == uint64_t{1} << 31);

}  // namespace
}  // namespace shoal::topics
