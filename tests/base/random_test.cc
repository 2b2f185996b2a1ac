// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/random.h"

#include <array>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace shoal {
namespace {

TEST(RandomTest, IsAFunctionOfItsKeyAndTheCount) {
  Random a(1, 2, 3, 4), b(1, 2, 3, 4);
  for (int i = 0; i < 100; ++i) ASSERT_EQ(a(), b());
}

// Within a mission, which is one seed. (Across missions it does not hold: seed and first part may change
// places.)
TEST(RandomTest, UnderOneSeedEveryPartOfTheKeyMatters) {
  std::set<uint64_t> first;
  for (uint64_t a = 0; a < 6; ++a)
    for (uint64_t b = 0; b < 6; ++b)
      for (uint64_t c = 0; c < 6; ++c) first.insert(Random(5, a, b, c)());
  EXPECT_EQ(first.size(), 216u);
}

// SplitMix64's published first output for state 0 (Vigna's reference code).
TEST(RandomTest, Mix64IsSplitMix64) { EXPECT_EQ(mix64(0), 0xe220a8397b1dcdafu); }

// 60,000 draws in 6 bins: each within 5 standard deviations of 10,000, sqrt(60000 x 1/6 x 5/6) = 91.
TEST(RandomTest, BelowIsUniform) {
  std::array<int, 6> bins{};
  Random random(7);
  for (int i = 0; i < 60000; ++i) ++bins.at(random.below(6));
  for (const int count : bins) EXPECT_NEAR(count, 10000, 460);
}

TEST(RandomTest, UniformStaysBelowOneAndHasMeanOneHalf) {
  Random random(8);
  double sum = 0;
  for (int i = 0; i < 100000; ++i) {
    const double u = random.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
  }
  EXPECT_NEAR(sum / 100000, 0.5, 5 / std::sqrt(12.0 * 100000));
}

TEST(DemandTest, AFalseDemandAborts) { EXPECT_DEATH(SHOAL_DEMAND(1 == 2), "demand failed: 1 == 2"); }

TEST(DemandTest, NothingIsBelowZero) { EXPECT_DEATH(Random(1).below(0), "demand failed"); }

}  // namespace
}  // namespace shoal
