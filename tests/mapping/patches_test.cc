// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/patches.h"

#include <limits>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "shoal/random.h"

namespace shoal::mapping {
namespace {

using world::GlobalLabel;
using world::RobotId;

constexpr GlobalLabel kCoral{7};

// A map drawn from above, row 0 in the north: '#' is coral, '.' is sand, ' ' was never seen.
GlobalMap drawn(const std::vector<std::string>& rows) {
  GlobalMap map;
  for (size_t row = 0; row < rows.size(); ++row) {
    for (size_t column = 0; column < rows[row].size(); ++column) {
      if (rows[row][column] == ' ') continue;
      const world::CellIndex cell{static_cast<int32_t>(column), -static_cast<int32_t>(row), 0};
      map.cells.push_back({cell, rows[row][column] == '#' ? kCoral : GlobalLabel{1}, RobotId{0}, {0}, 1.f});
    }
  }
  std::ranges::sort(map.cells, {}, &GlobalCell::cell);
  return map;
}

//   Cells of 2 m: two patches, for corners connect; the lone cell is a third.
TEST(PatchesTest, ConnectAtCornersAndComeLargestFirst) {
  const GlobalMap map = drawn({"##..#",  //
                               "..#..",  //
                               "#...."});
  const auto patches = patchesOf(map, world::Grid(2), kCoral);
  ASSERT_EQ(patches.size(), 3u);
  EXPECT_EQ(patches[0].columns, (std::vector<Column>{{0, 0}, {1, 0}, {2, -1}}));
  EXPECT_DOUBLE_EQ(patches[0].area_m2, 12);
  EXPECT_DOUBLE_EQ(patches[0].x_m, 2);  // columns at 0, 2 and 4 m
  EXPECT_DOUBLE_EQ(patches[0].y_m, -2.0 / 3);
  EXPECT_DOUBLE_EQ(patches[0].min_x_m, -1);
  EXPECT_DOUBLE_EQ(patches[0].max_x_m, 5);
  EXPECT_DOUBLE_EQ(patches[0].min_y_m, -3);
  EXPECT_DOUBLE_EQ(patches[0].max_y_m, 1);
  EXPECT_EQ(patches[1].columns, (std::vector<Column>{{0, -2}}));  // of equal size: the lower column first
  EXPECT_EQ(patches[2].columns, (std::vector<Column>{{4, 0}}));
}

TEST(PatchesTest, TellWhoSawThemWhenAndHowSurely) {
  GlobalMap map;
  map.cells = {{{0, 0, 0}, kCoral, RobotId{4}, {50}, 0.25f},
               {{0, 0, 1}, kCoral, RobotId{2}, {20}, 0.5f},  // above: the same ground
               {{1, 0, 5}, kCoral, RobotId{4}, {90}, 0.75f}};
  const auto patches = patchesOf(map, world::Grid(1), kCoral);
  ASSERT_EQ(patches.size(), 1u);
  EXPECT_EQ(patches[0].cells, 3);
  EXPECT_DOUBLE_EQ(patches[0].area_m2, 2);
  EXPECT_EQ(patches[0].robots, (std::vector{RobotId{2}, RobotId{4}}));
  EXPECT_EQ(patches[0].first_seen.us, 20);
  EXPECT_EQ(patches[0].last_seen.us, 90);
  EXPECT_DOUBLE_EQ(patches[0].certainty, 0.5);
}

// The bridge between two ends is uncertain and old: without it they are two patches.
TEST(PatchesTest, FiltersChooseCellsBeforeTheyConnectAndPatchesAfter) {
  GlobalMap map = drawn({"####"});
  map.cells[1].certainty = 0.5f;
  map.cells[1].seen = {10};
  for (const size_t i : {0, 2, 3}) map.cells[i].seen = {11};
  const world::Grid grid(1);
  EXPECT_EQ(patchesOf(map, grid, kCoral).size(), 1u);
  EXPECT_EQ(patchesOf(map, grid, kCoral, {.certainty = 0.5}).size(), 1u);
  EXPECT_EQ(patchesOf(map, grid, kCoral, {.certainty = 0.51}).size(), 2u);
  EXPECT_EQ(patchesOf(map, grid, kCoral, {.since = world::Timestamp{10}}).size(), 1u);
  EXPECT_EQ(patchesOf(map, grid, kCoral, {.since = world::Timestamp{11}}).size(), 2u);
  EXPECT_EQ(patchesOf(map, grid, kCoral, {.min_m2 = 2, .certainty = 0.51}).size(), 1u);
  EXPECT_EQ(patchesOf(map, grid, kCoral, {.since = world::Timestamp{12}}).size(), 0u);
}

TEST(PatchesTest, HoldAtTheEdgeOfAllIndices) {
  GlobalMap map;
  const int32_t last = std::numeric_limits<int32_t>::max();
  map.cells = {{{-last - 1, 0, 0}, kCoral, RobotId{0}, {0}, 1.f},
               {{last, 0, 0}, kCoral, RobotId{0}, {0}, 1.f}};
  EXPECT_EQ(patchesOf(map, world::Grid(1), kCoral).size(), 2u);
}

TEST(PatchesTest, RefuseFiltersThatMeanNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {-1.0, nan})
    EXPECT_THROW(patchesOf({}, world::Grid(1), kCoral, {.min_m2 = bad}), std::invalid_argument);
  for (const double bad : {-0.1, 1.1, nan})
    EXPECT_THROW(patchesOf({}, world::Grid(1), kCoral, {.certainty = bad}), std::invalid_argument);
}

// Whatever the drawing: every cell in one patch, cells of two patches never touch, and two cells of one patch
// are joined by steps within it (flood fill from the definition).
TEST(PatchesTest, AreTheConnectedComponentsOfAnyMap) {
  Random random(3);
  for (int trial = 0; trial < 30; ++trial) {
    SCOPED_TRACE(trial);
    std::vector<std::string> rows(12, std::string(15, '.'));
    for (std::string& row : rows)
      for (char& c : row) c = random.uniform() < 0.35 ? '#' : '.';
    const GlobalMap map = drawn(rows);
    std::map<Column, size_t> patch_of;
    const auto patches = patchesOf(map, world::Grid(1), kCoral);
    for (size_t i = 0; i < patches.size(); ++i)
      for (const Column& c : patches[i].columns) EXPECT_TRUE(patch_of.emplace(c, i).second);
    EXPECT_EQ(static_cast<int64_t>(patch_of.size()),
              std::ranges::count(map.cells, kCoral, &GlobalCell::label));
    const auto touch = [](const Column& a, const Column& b) {
      return std::abs(a.first - b.first) <= 1 && std::abs(a.second - b.second) <= 1;
    };
    for (const auto& [a, i] : patch_of)
      for (const auto& [b, j] : patch_of) EXPECT_TRUE(!touch(a, b) || i == j);
    for (const Patch& patch : patches) {
      std::vector<Column> reached = {patch.columns.front()};
      for (size_t next = 0; next < reached.size(); ++next) {
        for (const Column& c : patch.columns) {
          if (touch(c, reached[next]) && std::ranges::find(reached, c) == reached.end()) reached.push_back(c);
        }
      }
      EXPECT_EQ(reached.size(), patch.columns.size());
    }
  }
}

}  // namespace
}  // namespace shoal::mapping
