// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/cell_certainty.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shoal/random.h"
#include "shoal/topics/fixed_log.h"

namespace shoal::topics {
namespace {

double defined(double own, double other, double words, double group) {
  return 1 / (1 + std::exp2(1.0625 - 0.625 * ((2 * own - other) / words + group)));
}

TEST(CellCertaintyTest, IsTheDefinition) {
  Random random(1);
  for (int i = 0; i < 10000; ++i) {
    const auto words = static_cast<int64_t>(1 + random.below(600));
    const double own = -static_cast<double>(words) * 12 * random.uniform();
    const double other = -static_cast<double>(words) * 12 * random.uniform();
    const auto fixed = [](double log) { return static_cast<int64_t>(log * static_cast<double>(kLogOne)); };
    EXPECT_NEAR(cellCertainty(fixed(own), fixed(other), words, fixed(7.2)),
                defined(own, other, static_cast<double>(words), 7.2), 1e-4);
  }
}

// Ten words that are explained no better than by chance, and no other topic is worse: 1 / (1 + 2^1.0625).
TEST(CellCertaintyTest, WithoutEvidenceIsAThird) {
  EXPECT_NEAR(cellCertainty(-10 * 7 * kLogOne, -10 * 7 * kLogOne, 10, 7 * kLogOne), 0.3238, 1e-4);
}

TEST(CellCertaintyTest, StaysBetweenZeroAndOne) {
  EXPECT_EQ(cellCertainty(0, -1'000'000 * kLogOne, 1, 7 * kLogOne), 1.F);
  EXPECT_EQ(cellCertainty(-1'000'000 * kLogOne, 0, 1, 7 * kLogOne), 0.F);
}

}  // namespace
}  // namespace shoal::topics
