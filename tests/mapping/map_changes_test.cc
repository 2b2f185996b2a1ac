// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/map_changes.h"

#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "shoal/mapping/map_files.h"

namespace shoal::mapping {
namespace {

using Json = nlohmann::ordered_json;

// A view whose cells come and go at random, some far away and below zero.
struct GrowingMap {
  std::mt19937 random{7};
  std::map<world::CellIndex, GlobalCell> cells;
  uint64_t version = 0;

  void change(int count) {
    ++version;
    std::uniform_int_distribution<int32_t> place(-200, 200), any(0, 99);
    for (int n = 0; n < count; ++n) {
      const world::CellIndex cell{place(random), place(random), any(random) % 2};
      if (any(random) < 20) {
        cells.erase(cell);
        continue;
      }
      cells[cell] = {cell,
                     world::globalLabel(world::RobotId{any(random) % 3}, world::TopicId{any(random) % 5}),
                     world::RobotId{any(random) % 3}, world::Timestamp{any(random) * 1000}, 0.5f};
    }
  }
  MissionView view() const {
    MissionView view{.mission = 1, .cell_size_m = 0.25, .map = {}, .nodes = {}};
    std::map<world::GlobalLabel, int64_t> count;
    for (const auto& [index, cell] : cells) {
      view.map.cells.push_back(cell);
      ++count[cell.label];
    }
    for (const auto& [label, n] : count)
      view.map.labels.push_back({.label = label,
                                 .name = version % 2 == 0 ? "even" : "",
                                 .cells = n,
                                 .robots = {},
                                 .first_seen = {}});
    view.map_digest = view.map.digest();
    return view;
  }
};

// What somebody who was told everything would have.
GlobalMap toldWhole(const MissionView& view) {
  const world::Grid grid(view.cell_size_m);
  return parseGlobalMap(globalMapCsv(view.map, grid), labelsCsv(view.map, grid), grid, "test");
}

Json ask(MapChanges& changes, const MissionView& view, const std::string& has) {
  return Json::parse(changes.answer(view, {{"query", "map"}, {"has", has}}).dump());  // as it travels
}

TEST(MapChangesTest, WhoTakesChangesHasTheWholeMap) {
  GrowingMap growing;
  MapChanges changes;
  GlobalMap map;
  std::string has;
  for (int turn = 0; turn < 60; ++turn) {
    growing.change(turn == 30 ? 5000 : turn % 7 * 3);
    const MissionView view = growing.view();
    const Json answer = ask(changes, view, has);
    EXPECT_EQ(answer.contains("blocks"), turn > 0);
    has = takeChanges(map, answer, "test");
    EXPECT_EQ(has, digestText(view.map_digest));
    const GlobalMap whole = toldWhole(view);
    ASSERT_EQ(map.cells, whole.cells) << "turn " << turn;
    ASSERT_EQ(map.labels, whole.labels) << "turn " << turn;
  }
}

TEST(MapChangesTest, TellsOnlyBlocksThatChanged) {
  GrowingMap growing;
  growing.change(20000);
  MapChanges changes;
  const std::string has = ask(changes, growing.view(), "").at("digest");
  EXPECT_EQ(ask(changes, growing.view(), has).at("blocks"), Json::array());
  const world::CellIndex cell{-65, 64, 0};  // the block beyond -64 is -2
  growing.cells[cell] = {
      cell, world::globalLabel(world::RobotId{9}, world::TopicId{9}), world::RobotId{9}, {}, 1};
  EXPECT_EQ(ask(changes, growing.view(), has).at("blocks"), Json::parse("[[-2, 1]]"));
}

TEST(MapChangesTest, WhoeverHasAnUnknownMapIsToldAll) {
  GrowingMap growing;
  growing.change(500);
  MapChanges changes;
  const std::string first = ask(changes, growing.view(), "").at("digest");
  for (int turn = 0; turn < 3; ++turn) {
    growing.change(5);
    EXPECT_TRUE(ask(changes, growing.view(), first).contains("blocks")) << turn;
  }
  growing.change(5);
  ask(changes, growing.view(), "");  // the fifth map: the first is forgotten
  EXPECT_FALSE(ask(changes, growing.view(), first).contains("blocks"));
  EXPECT_FALSE(ask(changes, growing.view(), "no digest").contains("blocks"));
  EXPECT_THROW(changes.answer(growing.view(), {{"has", 7}}), Json::exception);
}

TEST(MapChangesTest, AnAnswerWithoutADigestIsWhole) {
  GrowingMap growing;
  growing.change(100);
  const MissionView view = growing.view();
  const world::Grid grid(view.cell_size_m);
  GlobalMap map = view.map;
  EXPECT_EQ(takeChanges(map,
                        {{"cell_size_m", 0.25},
                         {"global_map_csv", globalMapCsv(view.map, grid)},
                         {"labels_csv", labelsCsv(view.map, grid)}},
                        "test"),
            "");
  EXPECT_EQ(map.cells, toldWhole(view).cells);
}

}  // namespace
}  // namespace shoal::mapping
