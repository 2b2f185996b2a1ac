// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/neighborhood.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <set>
#include <vector>

#include "shoal/random.h"

namespace shoal::topics {
namespace {

using world::CellIndex;

std::set<int32_t> neighbors(const Neighborhood& neighborhood, int32_t cell) {
  const auto links = neighborhood.of(cell);
  return {links.begin(), links.end()};
}

TEST(NeighborhoodTest, NumbersCellsByFirstSight) {
  Neighborhood neighborhood;
  EXPECT_EQ(neighborhood.insert({5, 5, 5}), 0);
  EXPECT_EQ(neighborhood.insert({-5, 5, 5}), 1);
  EXPECT_EQ(neighborhood.insert({5, 5, 5}), 0);
  EXPECT_EQ(neighborhood.size(), 2);
}

// Six faces adjoin, around a cell whose neighbours have negative coordinates; the corner does not.
TEST(NeighborhoodTest, LinksTheSixFacesBothWays) {
  Neighborhood neighborhood;
  const int32_t middle = neighborhood.insert({0, 0, 0});
  std::set<int32_t> faces;
  for (const CellIndex& face : {CellIndex{-1, 0, 0}, CellIndex{1, 0, 0}, CellIndex{0, -1, 0},
                                CellIndex{0, 1, 0}, CellIndex{0, 0, -1}, CellIndex{0, 0, 1}}) {
    faces.insert(neighborhood.insert(face));
  }
  const int32_t corner = neighborhood.insert({-1, -1, 0});
  EXPECT_EQ(neighbors(neighborhood, middle), faces);
  for (const int32_t face : faces) EXPECT_TRUE(neighbors(neighborhood, face).contains(middle));
  EXPECT_FALSE(neighbors(neighborhood, corner).contains(middle));
  EXPECT_EQ(neighbors(neighborhood, corner).size(), 2u);  // it adjoins two of the faces
}

// By the definition: cells adjoin whose coordinates differ by 1 in all.
TEST(NeighborhoodTest, AgreesWithBruteForceInAnyOrder) {
  Random random(3);
  Neighborhood neighborhood;
  std::vector<CellIndex> cells;
  for (int i = 0; i < 400; ++i) {
    const auto coordinate = [&] { return static_cast<int32_t>(random.below(7)) - 3; };
    const CellIndex cell{coordinate(), coordinate(), coordinate()};
    if (neighborhood.insert(cell) == static_cast<int32_t>(cells.size())) cells.push_back(cell);
  }
  for (size_t a = 0; a < cells.size(); ++a) {
    std::set<int32_t> expected;
    for (size_t b = 0; b < cells.size(); ++b) {
      const int distance = std::abs(cells[a].x - cells[b].x) + std::abs(cells[a].y - cells[b].y) +
                           std::abs(cells[a].z - cells[b].z);
      if (distance == 1) expected.insert(static_cast<int32_t>(b));
    }
    EXPECT_EQ(neighbors(neighborhood, static_cast<int32_t>(a)), expected);
    EXPECT_EQ(neighborhood.of(static_cast<int32_t>(a)).size(), expected.size());  // none twice
  }
}

TEST(NeighborhoodTest, TheWorldDoesNotWrapAtItsEnds) {
  Neighborhood neighborhood;
  const int32_t low = neighborhood.insert({std::numeric_limits<int32_t>::min(), 0, 0});
  const int32_t high = neighborhood.insert({std::numeric_limits<int32_t>::max(), 0, 0});
  EXPECT_TRUE(neighbors(neighborhood, low).empty());
  EXPECT_TRUE(neighbors(neighborhood, high).empty());
}

}  // namespace
}  // namespace shoal::topics
