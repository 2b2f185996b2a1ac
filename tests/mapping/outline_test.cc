// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/outline.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

#include "shoal/random.h"

namespace shoal::mapping {
namespace {

// Columns drawn from above, the last row at y = 0.
std::vector<Column> drawn(const std::vector<std::string>& rows) {
  std::vector<Column> columns;
  for (size_t row = 0; row < rows.size(); ++row) {
    for (size_t x = 0; x < rows[row].size(); ++x) {
      if (rows[row][x] == '#') {
        columns.emplace_back(static_cast<int64_t>(x), static_cast<int64_t>(rows.size() - 1 - row));
      }
    }
  }
  std::ranges::sort(columns);
  return columns;
}

// Twice the area to the left of a ring: positive when it runs counter-clockwise. The shoelace formula.
int64_t doubleArea(const Ring& ring) {
  int64_t sum = 0;
  for (size_t i = 0; i < ring.size(); ++i) {
    const auto& [x1, y1] = ring[i];
    const auto& [x2, y2] = ring[(i + 1) % ring.size()];
    sum += x1 * y2 - x2 * y1;
  }
  return sum;
}

// All corners on the way, those without a turn too.
std::vector<Corner> walked(const Ring& ring) {
  std::vector<Corner> corners;
  const auto sign = [](int64_t v) { return static_cast<int64_t>(v > 0) - static_cast<int64_t>(v < 0); };
  for (size_t i = 0; i < ring.size(); ++i) {
    Corner at = ring[i];
    const Corner to = ring[(i + 1) % ring.size()];
    EXPECT_TRUE((at.first == to.first) != (at.second == to.second)) << "neither along x nor along y";
    for (; at != to; at = {at.first + sign(to.first - at.first), at.second + sign(to.second - at.second)})
      corners.push_back(at);
  }
  return corners;
}

// Even-odd rule: edges of the ring that a ray from the column's centre to the east crosses.
bool encloses(const Ring& ring, const Column& column) {
  bool inside = false;
  for (size_t i = 0; i < ring.size(); ++i) {
    const auto& [x1, y1] = ring[i];
    const auto& [x2, y2] = ring[(i + 1) % ring.size()];
    if (x1 != x2 || x1 <= column.first) continue;
    if (std::min(y1, y2) <= column.second && column.second < std::max(y1, y2)) inside = !inside;
  }
  return inside;
}

TEST(OutlineTest, OfOneColumnIsItsSquare) {
  const auto polygons = outlineOf(std::vector<Column>{{3, -2}});
  ASSERT_EQ(polygons.size(), 1u);
  EXPECT_EQ(polygons[0].outer, (Ring{{3, -2}, {4, -2}, {4, -1}, {3, -1}}));
  EXPECT_TRUE(polygons[0].holes.empty());
}

TEST(OutlineTest, TurnsOnlyWhereTheGroundDoes) {
  const auto polygons = outlineOf(drawn({"#..",  //
                                         "###"}));
  ASSERT_EQ(polygons.size(), 1u);
  EXPECT_EQ(polygons[0].outer, (Ring{{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {0, 2}}));
}

TEST(OutlineTest, KeepsColumnsApartThatMeetAtACorner) {
  const auto polygons = outlineOf(drawn({".#",  //
                                         "#."}));
  ASSERT_EQ(polygons.size(), 2u);
  EXPECT_EQ(polygons[0].outer, (Ring{{0, 0}, {1, 0}, {1, 1}, {0, 1}}));
  EXPECT_EQ(polygons[1].outer, (Ring{{1, 1}, {2, 1}, {2, 2}, {1, 2}}));
}

TEST(OutlineTest, HasHolesThatRunClockwise) {
  const auto polygons = outlineOf(drawn({"###",  //
                                         "#.#",  //
                                         "###"}));
  ASSERT_EQ(polygons.size(), 1u);
  ASSERT_EQ(polygons[0].holes.size(), 1u);
  EXPECT_EQ(doubleArea(polygons[0].outer), 18);
  EXPECT_EQ(polygons[0].holes[0], (Ring{{1, 1}, {1, 2}, {2, 2}, {2, 1}}));
}

// The two ends of the hook meet at a corner: what they enclose is a hole that touches the outside there, and
// no ring crosses itself.
TEST(OutlineTest, ClosesAHoleAtACorner) {
  const auto polygons = outlineOf(drawn({"##.",  //
                                         "#.#",  //
                                         "###"}));
  ASSERT_EQ(polygons.size(), 1u);
  ASSERT_EQ(polygons[0].holes.size(), 1u);
  EXPECT_EQ(doubleArea(polygons[0].holes[0]), -2);
  EXPECT_EQ(doubleArea(polygons[0].outer), 2 * (7 + 1));
}

TEST(OutlineTest, OfNothingIsNothing) { EXPECT_TRUE(outlineOf({}).empty()); }

// For any drawing: rings are simple, outer ones run counter-clockwise and holes clockwise, and a column lies
// within exactly one polygon if it is in the set, and in none if it is not.
TEST(OutlineTest, IsExactForAnySet) {
  Random random(5);
  for (int trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE(trial);
    std::set<Column> set;
    const double density = 0.2 + 0.7 * random.uniform();
    for (int64_t x = -5; x < 6; ++x)
      for (int64_t y = -4; y < 5; ++y)
        if (random.uniform() < density) set.emplace(x, y);
    const auto polygons = outlineOf(std::vector<Column>(set.begin(), set.end()));
    int64_t double_area = 0;
    for (const Polygon& polygon : polygons) {
      EXPECT_GT(doubleArea(polygon.outer), 0);
      std::vector<Ring> rings = polygon.holes;
      for (const Ring& hole : rings) EXPECT_LT(doubleArea(hole), 0);
      rings.push_back(polygon.outer);
      for (const Ring& ring : rings) {
        const std::vector<Corner> corners = walked(ring);
        EXPECT_EQ(std::set<Corner>(corners.begin(), corners.end()).size(), corners.size());
        double_area += doubleArea(ring);
      }
    }
    EXPECT_EQ(double_area, 2 * std::ssize(set));
    for (int64_t x = -6; x < 7; ++x) {
      for (int64_t y = -5; y < 6; ++y) {
        int64_t within = 0;
        for (const Polygon& polygon : polygons) {
          if (!encloses(polygon.outer, {x, y})) continue;
          within += std::ranges::none_of(polygon.holes, [&](const Ring& h) { return encloses(h, {x, y}); });
        }
        EXPECT_EQ(within, set.contains({x, y}) ? 1 : 0) << x << ' ' << y;
      }
    }
  }
}

}  // namespace
}  // namespace shoal::mapping
