// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include <gtest/gtest.h>

#include "shoal/world/survey.h"

namespace shoal::world {
namespace {

double area(const Extent& e) { return (e.max_x - e.min_x) * (e.max_y - e.min_y); }

bool onBorder(double p, double cell_size_m) {
  const double half_cells = p / cell_size_m + 0.5;
  return std::abs(half_cells - std::round(half_cells)) < 1e-9;
}

// Rectangles with disjoint insides and the area of the whole, all inside it, tile it.
TEST(SharesTest, TileTheExtentForEveryTeam) {
  for (const Extent& whole :
       {Extent{0, -250, 250, 0}, Extent{-0.5, -3173.5, 3377.5, 0.5}, Extent{-0.05, -40, 900, 0.05}}) {
    const Grid grid(whole.max_x > 3000 ? 24.0 : 0.8);
    for (int n = 1; n <= 50; ++n) {
      const std::vector<Extent> team = shares(whole, n, grid);
      ASSERT_EQ(team.size(), static_cast<size_t>(n));
      double sum = 0;
      for (size_t i = 0; i < team.size(); ++i) {
        const Extent& a = team[i];
        sum += area(a);
        for (const auto& [p, low, high] : {std::tuple{a.min_x, whole.min_x, whole.max_x},
                                           {a.max_x, whole.min_x, whole.max_x},
                                           {a.min_y, whole.min_y, whole.max_y},
                                           {a.max_y, whole.min_y, whole.max_y}}) {
          ASSERT_GE(p, low);
          ASSERT_LE(p, high);
          ASSERT_TRUE(p == low || p == high || onBorder(p, grid.cellSize())) << n << ": " << p;
        }
        ASSERT_LT(a.min_x, a.max_x);
        ASSERT_LT(a.min_y, a.max_y);
        for (size_t j = 0; j < i; ++j) {
          const Extent& b = team[j];
          ASSERT_TRUE(a.max_x <= b.min_x || b.max_x <= a.min_x || a.max_y <= b.min_y || b.max_y <= a.min_y)
              << n << ": " << i << " and " << j;
        }
      }
      EXPECT_NEAR(sum, area(whole), 1e-9 * area(whole)) << n;
    }
  }
}

// Each cut is at most half a cell from where it should be, on either side of a share.
TEST(SharesTest, AreAsEqualAsCellBordersAllow) {
  const Extent whole{0, -250, 250, 0};
  const double cell = 0.8;
  for (int n = 1; n <= 50; ++n) {
    for (const Extent& share : shares(whole, n, Grid(cell))) {
      const double slack = cell * ((share.max_x - share.min_x) + (share.max_y - share.min_y) + cell);
      EXPECT_NEAR(area(share), area(whole) / n, slack) << n;
    }
  }
}

// Three in a square of equal areas: one lies across (3 : 1) over two, which beats three strips.
TEST(SharesTest, AreNearlySquare) {
  for (int n = 1; n <= 50; ++n) {
    for (const Extent& share : shares({0, -250, 250, 0}, n, Grid(0.8))) {
      const double ratio = (share.max_x - share.min_x) / (share.max_y - share.min_y);
      EXPECT_LT(std::max(ratio, 1 / ratio), n == 3 ? 3.1 : 2.1) << n;
    }
  }
}

/// Robots per row, from the north.
std::vector<int> arrangement(const Extent& whole, int n) {
  std::map<double, int> rows;
  for (const Extent& share : shares(whole, n, Grid(0.8))) ++rows[-share.max_y];
  std::vector<int> counts;
  for (const auto& [y, count] : rows) counts.push_back(count);
  return counts;
}

TEST(SharesTest, StandInRowsAcrossASquare) {
  const Extent square{0, -250, 250, 0};
  EXPECT_EQ(arrangement(square, 1), (std::vector{1}));
  EXPECT_EQ(arrangement(square, 4), (std::vector{2, 2}));
  EXPECT_EQ(arrangement(square, 12), (std::vector{4, 4, 4}));
  EXPECT_EQ(arrangement(square, 16), (std::vector{4, 4, 4, 4}));
  EXPECT_EQ(arrangement({0, -50, 250, 0}, 5), (std::vector{5}));
  EXPECT_EQ(arrangement({0, -250, 50, 0}, 5), (std::vector{1, 1, 1, 1, 1}));
  // A prime number of robots: rows of different numbers, not a stack of strips.
  const std::vector<int> seven = arrangement(square, 7);
  EXPECT_EQ(seven.size(), 3u);
  EXPECT_EQ(*std::min_element(seven.begin(), seven.end()), 2);
  EXPECT_EQ(*std::max_element(seven.begin(), seven.end()), 3);
}

TEST(SharesTest, AreNumberedWestToEastFromTheNorth) {
  const std::vector<Extent> team = shares({0, -250, 250, 0}, 12, Grid(0.8));
  EXPECT_EQ(team[0].min_x, 0);
  EXPECT_EQ(team[0].max_y, 0);
  EXPECT_EQ(team[3].max_x, 250);
  EXPECT_EQ(team[3].max_y, 0);
  EXPECT_EQ(team[11].max_x, 250);
  EXPECT_EQ(team[11].min_y, -250);
}

TEST(SharesTest, RefuseATeamThatIsNoneOrTooLargeForTheCells) {
  const Extent whole{0, -10, 10, 0};
  EXPECT_THROW(shares(whole, 0, Grid(1)), std::invalid_argument);
  EXPECT_THROW(shares(whole, -3, Grid(1)), std::invalid_argument);
  EXPECT_THROW(shares(whole, 1000, Grid(1)), std::invalid_argument);
  EXPECT_THROW(shares(whole, 4, Grid(30)), std::invalid_argument);
}

}  // namespace
}  // namespace shoal::world
