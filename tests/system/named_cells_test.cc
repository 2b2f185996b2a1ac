// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/named_cells.h"

#include <map>
#include <set>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shoal/eval/ami_estimate.h"
#include "shoal/mapping/csv.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

const std::string kHeader = "x_m,y_m,z_m,robot,seen_s,name\n";

// 20 x 20 cells of half a metre: label 4 to the west, 10004 to the east.
mapping::MissionView halves() {
  mapping::MissionView view;
  view.mission = 7;
  view.cell_size_m = 0.5;
  for (int x = -10; x < 10; ++x)
    for (int y = 0; y < 20; ++y)
      view.map.cells.push_back({.cell = {x, y, 3},
                                .label = world::GlobalLabel{x < 0 ? 4 : 10004},
                                .robot = world::RobotId{x < 0 ? 0 : 1},
                                .seen = {1'500'000 + y},
                                .certainty = 1.f});
  view.map.labels.resize(2);
  view.map.labels[0].label = world::GlobalLabel{4};
  view.map.labels[0].name = "sand, fine";
  view.map.labels[1].label = world::GlobalLabel{10004};
  return view;
}

TEST(NamedCellsTest, DrawsCellsOfTheMapOnceEachWithoutTheirLabels) {
  const mapping::MissionView view = halves();
  const world::Grid grid(view.cell_size_m);
  const std::string csv = cellsToName(view, 50, 1);
  EXPECT_EQ(csv, cellsToName(view, 50, 1));
  EXPECT_NE(csv, cellsToName(view, 50, 2));
  EXPECT_EQ(csv.substr(0, kHeader.size()), kHeader);
  std::set<world::CellIndex> drawn;
  for (const auto& row : mapping::parseCsv(csv, {"x_m", "y_m", "z_m", "robot", "seen_s", "name"}, "drawn")) {
    const world::CellIndex cell =
        grid.cellOf({mapping::toReal(row[0], ""), mapping::toReal(row[1], ""), mapping::toReal(row[2], "")});
    EXPECT_TRUE(cell.x >= -10 && cell.x < 10 && cell.y >= 0 && cell.y < 20 && cell.z == 3);
    EXPECT_EQ(row[3], cell.x < 0 ? "R00" : "R01");
    EXPECT_EQ(row[4], "1.500");
    EXPECT_EQ(row[5], "");
    drawn.insert(cell);
  }
  EXPECT_EQ(drawn.size(), 50u);
  EXPECT_EQ(parseNamedCells(csv, grid, "drawn").unnamed, 50);
  EXPECT_EQ(parseNamedCells(cellsToName(view, 1000, 1), grid, "all").unnamed, 400);  // as many as there are
}

TEST(NamedCellsTest, EveryCellIsDrawnAsOftenAsAnyOther) {
  const mapping::MissionView view = halves();
  std::map<std::string, int> times;
  for (uint64_t seed = 0; seed < 4000; ++seed)
    for (const auto& row : mapping::parseCsv(cellsToName(view, 10, seed), {"x_m", "y_m"}, "drawn"))
      ++times[row[0] + " " + row[1]];
  ASSERT_EQ(times.size(), 400u);
  for (const auto& [cell, count] : times) {  // 100 each; 6 standard deviations
    EXPECT_GT(count, 40) << cell;
    EXPECT_LT(count, 160) << cell;
  }
}

TEST(NamedCellsTest, TheScoreIsTheEstimateOfLabelsAndNames) {
  const mapping::MissionView view = halves();
  const world::Grid grid(view.cell_size_m);
  std::string csv = kHeader;
  std::vector<int> labels, names;
  for (int i = 0; i < 30; ++i) {  // 10 cells of label 4, 20 of label 10004, of which five are sand as well
    const int x = i < 10 ? -1 : 2;
    const bool sand = i < 15;
    csv += mapping::fixed(0.5 * x + 0.1, 3) + ',' +
           mapping::fixed(0.5 * (i % 10) + (i >= 20 ? 5.0 : 0.0), 3) + ",1.5,R00,," +
           (sand ? " sand " : "\"coral, brain\"") + '\n';
    labels.push_back(x < 0 ? 4 : 10004);
    names.push_back(sand ? 1 : 2);
  }
  csv += "90,0,1.5,,,sand\n4,9,1.5,,,\n";  // off the map; no name
  const Json a = namedScore(view, parseNamedCells(csv, grid, "named.csv"));
  const eval::AmiEstimate e = eval::estimateAmi(labels, names, 400);
  EXPECT_NEAR(a["ami"].get<double>(), e.ami, 1e-6);
  EXPECT_NEAR(a["low"].get<double>(), e.low, 1e-6);
  EXPECT_NEAR(a["high"].get<double>(), e.high, 1e-6);
  EXPECT_EQ(a["cells"], 400);
  EXPECT_EQ(a["named"], 30);
  EXPECT_EQ(a["unnamed"], 1);
  EXPECT_EQ(a["off_map"], 1);
  EXPECT_EQ(a["labels"], 2);
  EXPECT_EQ(a["names"], 2);
  EXPECT_EQ(a["by_label"], Json::parse(R"([
    {"label": 10004, "name": "", "named": 20, "most_often": "coral, brain", "share": 0.75},
    {"label": 4, "name": "sand, fine", "named": 10, "most_often": "sand", "share": 1.0}])"));
}

TEST(NamedCellsTest, WhatIsWrongIsSaidWithItsLine) {
  const world::Grid grid(0.5);
  const auto said = [&grid](const std::string& csv) {
    try {
      parseNamedCells(csv, grid, "n.csv");
    } catch (const std::runtime_error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(said("x_m,y_m,name\n"), "n.csv: column 3 should be \"z_m\", is \"name\"");
  EXPECT_EQ(said(kHeader + "1,2,3,,,a\n1,two,3,,,a\n"), "n.csv line 3: \"two\" is not a number");
  EXPECT_EQ(said(kHeader + "1e300,2,3,,,a\n"), "n.csv line 2: 1e300 m is out of reach");
  EXPECT_EQ(said(kHeader + "nan,2,3,,,a\n"), "n.csv line 2: nan m is out of reach");
  EXPECT_EQ(said(kHeader + "1,2,3,,,a\n1.1,2,3,,,b\n"), "n.csv line 3: this cell stands above already");
  EXPECT_EQ(said(kHeader + "1,2,3\n"), "n.csv line 2: 3 fields, should be 6");
  EXPECT_THROW(namedScore(halves(), {}), std::invalid_argument);
}

}  // namespace
}  // namespace shoal::console
