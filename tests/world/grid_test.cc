// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/grid.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "shoal/random.h"

namespace shoal::world {
namespace {

TEST(GridTest, RoundsToTheNearestCellAndHalfWayPointsUp) {
  const Grid grid(0.5);  // exact in binary, so that half-way is exactly half-way
  for (const auto& [x, cell] : {std::pair{0.0, 0},
                                {-0.0, 0},
                                {0.2, 0},
                                {-0.2, 0},
                                {0.25, 1},
                                {-0.25, 0},
                                {-0.26, -1},
                                {0.74, 1},
                                {0.75, 2},
                                {-0.75, -1},
                                {-0.76, -2},
                                {100.0, 200}}) {
    EXPECT_EQ(grid.cellOf({x, 0, 0}), (CellIndex{cell, 0, 0})) << x;
    EXPECT_EQ(grid.cellOf({0, x, 0}), (CellIndex{0, cell, 0})) << x;
    EXPECT_EQ(grid.cellOf({0, 0, x}), (CellIndex{0, 0, cell})) << x;
  }
}

TEST(GridTest, FindsEveryCentreInItsOwnCell) {
  Random random(7);
  for (const double size : {0.1, 0.8, 2.4, 24.0}) {
    const Grid grid(size);
    for (int i = 0; i < 1000; ++i) {
      const auto index = [&] { return static_cast<int32_t>(random.below(20001)) - 10000; };
      const CellIndex cell{index(), index(), index()};
      ASSERT_EQ(grid.cellOf(grid.centerOf(cell)), cell);
    }
  }
}

TEST(GridTest, PutsEveryPointWithinHalfACellOfItsCentre) {
  Random random(8);
  const Grid grid(0.8);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d p =
        500.0 * Eigen::Vector3d(random.uniform(), random.uniform(), random.uniform()).array() - 250.0;
    EXPECT_LE((p - grid.centerOf(grid.cellOf(p))).cwiseAbs().maxCoeff(), 0.4 + 1e-9);
  }
}

TEST(GridTest, RefusesACellWithoutSize) {
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(Grid{bad}, std::invalid_argument) << bad;
  }
}

}  // namespace
}  // namespace shoal::world
