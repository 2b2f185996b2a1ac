// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/fixed_math.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "shoal/random.h"

namespace shoal::vision {
namespace {

std::vector<uint64_t> numbersOfAllSizes() {
  std::vector<uint64_t> numbers;
  for (uint64_t x = 1; x < 3000; ++x) numbers.push_back(x);
  Random random(1);
  for (int bits = 12; bits < 60; ++bits) {
    const uint64_t power = uint64_t{1} << bits;
    for (int i = 0; i < 50; ++i) numbers.push_back(power + random.below(power));
    numbers.push_back(power - 1);
    numbers.push_back(power);
  }
  return numbers;
}

TEST(FixedMathTest, LogarithmsAreTheFloorOfTheTrueOnes) {
  for (const int bits : {0, 7, 10, 16}) {
    for (const uint64_t x : numbersOfAllSizes()) {
      const double exact = std::log2(static_cast<double>(x)) * (1 << bits);
      const int32_t log = fixedLog2(x, bits);
      ASSERT_LE(log, exact + 1e-6) << x << ", " << bits << " bits";
      ASSERT_GT(log, exact - 1.01) << x << ", " << bits << " bits";
    }
  }
}

TEST(FixedMathTest, LogarithmsOfPowersAreExactAndNeverFall) {
  for (int power = 0; power < 64; ++power) EXPECT_EQ(fixedLog2(uint64_t{1} << power, 10), power << 10);
  for (uint64_t x = 1; x < 100000; ++x) ASSERT_LE(fixedLog2(x, 16), fixedLog2(x + 1, 16)) << x;
}

TEST(FixedMathTest, PowersOfTwoAreWithinTheirBound) {
  for (int32_t exponent = -(1 << 20); exponent < 1 << 20; exponent += 97) {
    const double exact = std::exp2(exponent / 65536.0) * 65536.0;
    const auto power = static_cast<double>(fixedExp2(exponent));
    ASSERT_LE(power, exact * (1 + 1e-12)) << exponent;
    ASSERT_GT(power, exact * (1 - 1e-7) - 1) << exponent;
  }
  for (int whole = -16; whole < 16; ++whole) EXPECT_EQ(fixedExp2(whole * 65536), uint64_t{1} << (whole + 16));
}

TEST(FixedMathTest, RootsAreTheFloorOfTheTrueOnes) {
  for (const uint64_t x : numbersOfAllSizes()) {
    const uint64_t square = integerSquareRoot(x), cube = integerCubeRoot(x);
    ASSERT_TRUE(square * square <= x && x < (square + 1) * (square + 1)) << x;
    ASSERT_TRUE(cube * cube * cube <= x && x < (cube + 1) * (cube + 1) * (cube + 1)) << x;
  }
  EXPECT_EQ(integerSquareRoot(0), 0u);
  EXPECT_EQ(integerCubeRoot(0), 0u);
  EXPECT_EQ(integerSquareRoot(uint64_t{1} << 62), uint64_t{1} << 31);
  EXPECT_EQ(integerCubeRoot(uint64_t{1} << 60), uint64_t{1} << 20);
}

}  // namespace
}  // namespace shoal::vision
