// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace shoal::eval {
namespace {

// Quantiles as printed in tables of Student's distribution.
TEST(StatisticsTest, StudentsQuantilesAreThoseOfTheTables) {
  EXPECT_NEAR(studentQuantile(1), 12.706, 1e-3);
  EXPECT_NEAR(studentQuantile(10), 2.228, 1e-3);
  EXPECT_NEAR(studentQuantile(11), 2.201, 1e-3);
  EXPECT_NEAR(studentQuantile(23), 2.069, 1e-3);
  EXPECT_NEAR(studentQuantile(120), 1.980, 1e-3);
  EXPECT_THROW(studentQuantile(0), std::invalid_argument);
}

// 2, 4, 4, 4, 5, 5, 7, 9: mean 5, squares 32, deviation sqrt(32/7).
TEST(StatisticsTest, SummaryOfASampleWorkedByHand) {
  const std::vector<double> sample{2, 4, 4, 4, 5, 5, 7, 9};
  const Summary s = summarize(sample);
  EXPECT_EQ(s.count, 8);
  EXPECT_DOUBLE_EQ(s.mean, 5.0);
  EXPECT_NEAR(s.deviation, std::sqrt(32.0 / 7.0), 1e-12);
  EXPECT_NEAR(s.margin, 2.3646 * std::sqrt(32.0 / 7.0) / std::sqrt(8.0), 1e-9);
  EXPECT_EQ(summarize(std::vector<double>{3.0}).margin, 0.0);
  EXPECT_EQ(summarize({}).count, 0);
}

// Points (1, 2), (2, 2), (3, 4): slope 1, intercept 2/3, residuals 1/3, -2/3, 1/3.
TEST(StatisticsTest, LineThroughThreePointsWorkedByHand) {
  const Line line = fitLine(std::vector<double>{1, 2, 3}, std::vector<double>{2, 2, 4});
  EXPECT_NEAR(line.slope, 1.0, 1e-12);
  EXPECT_NEAR(line.intercept, 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(line.slope_margin, 12.7062 * std::sqrt((6.0 / 9.0) / 1 / 2), 1e-6);
  EXPECT_EQ(fitLine(std::vector<double>{1, 1}, std::vector<double>{2, 5}).slope, 0.0);
}

}  // namespace
}  // namespace shoal::eval
