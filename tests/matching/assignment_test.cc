// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/assignment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>
#include <stdexcept>
#include <vector>

#include "shoal/random.h"

namespace shoal::matching {
namespace {

double costOf(const Eigen::MatrixXd& cost, const std::vector<int>& column) {
  double sum = 0.0;
  for (size_t i = 0; i < column.size(); ++i) sum += cost(static_cast<Eigen::Index>(i), column[i]);
  return sum;
}

// The least cost over all ways to give the rows distinct columns.
double leastCost(const Eigen::MatrixXd& cost) {
  std::vector<int> column(static_cast<size_t>(cost.cols()));
  std::iota(column.begin(), column.end(), 0);
  double least = std::numeric_limits<double>::infinity();
  do {
    least = std::min(least, costOf(cost, {column.begin(), column.begin() + cost.rows()}));
  } while (std::next_permutation(column.begin(), column.end()));
  return least;
}

TEST(AssignTest, SolvesAnExampleByHand) {
  Eigen::Matrix3d cost;
  cost << 4, 1, 3,  //
      2, 0, 5,      //
      3, 2, 2;
  EXPECT_EQ(assign(cost), (std::vector{1, 0, 2}));  // 1 + 2 + 2; the greedy choice 0 + 2 + 4 costs more
}

// Whole numbers with many ties, negative ones too; every shape up to 5 by 7.
TEST(AssignTest, IsAsCheapAsTheBestOfAllAssignments) {
  Random random(1);
  for (int trial = 0; trial < 300; ++trial) {
    const auto rows = static_cast<Eigen::Index>(1 + random.below(5));
    const auto columns = rows + static_cast<Eigen::Index>(random.below(static_cast<uint64_t>(8 - rows)));
    const uint64_t range = trial % 2 == 0 ? 4 : 1000;
    Eigen::MatrixXd cost(rows, columns);
    for (double& c : cost.reshaped())
      c = static_cast<double>(random.below(range)) - static_cast<double>(range / 3);
    const std::vector<int> column = assign(cost);
    ASSERT_EQ(std::set<int>(column.begin(), column.end()).size(), static_cast<size_t>(rows));
    EXPECT_EQ(costOf(cost, column), leastCost(cost)) << cost;
    EXPECT_EQ(assign(cost), column);
  }
}

TEST(AssignTest, HasNothingToDoWithoutRows) {
  EXPECT_TRUE(assign(Eigen::MatrixXd(0, 0)).empty());
  EXPECT_TRUE(assign(Eigen::MatrixXd(0, 3)).empty());
}

TEST(AssignTest, RejectsMoreRowsThanColumnsAndCostsThatAreNotFinite) {
  EXPECT_THROW(assign(Eigen::MatrixXd::Zero(3, 2)), std::invalid_argument);
  Eigen::MatrixXd cost = Eigen::MatrixXd::Zero(2, 2);
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    cost(1, 0) = bad;
    EXPECT_THROW(assign(cost), std::invalid_argument);
  }
}

}  // namespace
}  // namespace shoal::matching
