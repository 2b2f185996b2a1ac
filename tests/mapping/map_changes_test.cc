// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/map_changes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "shoal/mapping/map_files.h"
#include "shoal/mapping/queries.h"

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

// In columns, found plainly.
struct Columns {
  explicit Columns(const MissionView& of) : view(of) {
    for (const GlobalCell& c : view.map.cells) hashes[columnOf(c)] += hashOf(c);
  }
  static BrickColumn columnOf(const GlobalCell& c) {
    return {static_cast<int32_t>(std::floor(c.cell.x / 16.)),
            static_cast<int32_t>(std::floor(c.cell.y / 16.))};
  }
  static uint8_t surpriseOf(const GlobalCell& c) {  // anything that the cell decides
    return c.seen.us % 3 == 0 ? static_cast<uint8_t>(12 + c.seen.us / 1000 % 50) : uint8_t{0};
  }
  static uint64_t hashOf(const GlobalCell& c) {
    return cellHash(c.cell, c.robot, c.seen, c.certainty) * labelFactor(c.label);
  }
  MapInColumns map() const {
    return {view.cell_size_m,
            view.map_digest,
            view.map.labels,
            hashes,
            [this](const auto& columns) {
              std::vector<GlobalCell> cells;
              for (const GlobalCell& c : view.map.cells)
                if (columns.contains(columnOf(c))) cells.push_back(c);
              return cells;
            },
            [](std::span<const GlobalCell> cells) {
              std::vector<uint8_t> steps;
              for (const GlobalCell& c : cells) steps.push_back(surpriseOf(c));
              return steps;
            }};
  }
  const MissionView& view;
  std::map<BrickColumn, uint64_t> hashes;
};

// What who has heard every answer holds.
struct Holder {
  std::map<BrickColumn, std::vector<GlobalCell>> columns;
  std::string digest;

  void take(const Json& answer) {
    const MapChange change = readChange(answer, "test");
    if (change.is_whole) columns.clear();
    for (const BrickColumn& column : change.columns) columns.erase(column);
    ASSERT_EQ(change.surprises.size(), change.part.cells.size());
    for (size_t i = 0; i < change.part.cells.size(); ++i) {
      const GlobalCell& c = change.part.cells[i];
      ASSERT_EQ(change.surprises[i], Columns::surpriseOf(c));
      columns[Columns::columnOf(c)].push_back(c);
    }
    digest = change.digest;
    labels = change.part.labels;
  }
  std::vector<GlobalCell> cells() const {
    std::vector<GlobalCell> all;
    for (const auto& [column, some] : columns) all.insert(all.end(), some.begin(), some.end());
    std::ranges::sort(all, {}, &GlobalCell::cell);
    return all;
  }
  std::vector<LabelSummary> labels;
};

// What somebody who was told everything would have.
GlobalMap toldWhole(const MissionView& view) {
  const world::Grid grid(view.cell_size_m);
  return parseGlobalMap(globalMapCsv(view.map, grid), labelsCsv(view.map, grid), grid, "test");
}

Json ask(MapChanges& changes, const MissionView& view, const std::string& has) {
  return Json::parse(
      changes.answer(Columns(view).map(), {{"query", "map"}, {"has", has}}).dump());  // as it travels
}

TEST(MapChangesTest, WhoTakesChangesHasTheWholeMap) {
  GrowingMap growing;
  MapChanges changes;
  Holder holder;
  for (int turn = 0; turn < 60; ++turn) {
    growing.change(turn == 30 ? 5000 : turn % 7 * 3);
    const MissionView view = growing.view();
    const Json answer = ask(changes, view, holder.digest);
    EXPECT_EQ(answer.contains("columns"), turn > 0);
    holder.take(answer);
    EXPECT_EQ(holder.digest, digestText(view.map_digest));
    const GlobalMap whole = toldWhole(view);
    ASSERT_EQ(holder.cells(), whole.cells) << "turn " << turn;
    ASSERT_EQ(holder.labels, whole.labels) << "turn " << turn;
    ASSERT_EQ(answer.at("labels"), labelsAnswer(view).at("labels")) << "turn " << turn;
    ASSERT_EQ(answer.at("labels_csv"), labelsCsv(view.map, world::Grid(view.cell_size_m))) << "turn " << turn;
  }
}

TEST(MapChangesTest, TellsOnlyColumnsThatChanged) {
  GrowingMap growing;
  growing.change(20000);
  MapChanges changes;
  const std::string has = ask(changes, growing.view(), "").at("digest");
  EXPECT_EQ(ask(changes, growing.view(), has).at("columns"), Json::array());
  const world::CellIndex cell{-17, 16, 0};  // the column of bricks beyond -16 is -2
  growing.cells[cell] = {
      cell, world::globalLabel(world::RobotId{9}, world::TopicId{9}), world::RobotId{9}, {}, 1};
  EXPECT_EQ(ask(changes, growing.view(), has).at("columns"), Json::parse("[[-2, 1]]"));
}

TEST(MapChangesTest, WhoeverHasAnUnknownMapIsToldAll) {
  GrowingMap growing;
  growing.change(500);
  MapChanges changes;
  const std::string first = ask(changes, growing.view(), "").at("digest");
  for (int turn = 0; turn < 3; ++turn) {
    growing.change(5);
    EXPECT_TRUE(ask(changes, growing.view(), first).contains("columns")) << turn;
  }
  growing.change(5);
  ask(changes, growing.view(), "");  // the fifth map: the first is forgotten
  EXPECT_FALSE(ask(changes, growing.view(), first).contains("columns"));
  EXPECT_FALSE(ask(changes, growing.view(), "no digest").contains("columns"));
  const MissionView view = growing.view();
  EXPECT_THROW(changes.answer(Columns(view).map(), {{"has", 7}}), Json::exception);
}

TEST(MapChangesTest, AnAnswerWithoutADigestIsWhole) {
  GrowingMap growing;
  growing.change(100);
  const MissionView view = growing.view();
  const world::Grid grid(view.cell_size_m);
  Json answer{{"cell_size_m", 0.25},
              {"global_map_csv", globalMapCsv(view.map, grid)},
              {"labels_csv", labelsCsv(view.map, grid)}};
  const MapChange change = readChange(answer, "test");
  EXPECT_TRUE(change.is_whole);
  EXPECT_EQ(change.digest, "");
  EXPECT_EQ(change.part.cells, toldWhole(view).cells);
  answer["columns"] = Json::parse("[[99, 99]]");
  EXPECT_THROW(readChange(answer, "test"), std::runtime_error);
  answer.erase("columns");
  EXPECT_TRUE(change.surprises.empty());
  answer["surprises"] = Json::array({Json::array({1, 20})});
  EXPECT_EQ(readChange(answer, "test").surprises.at(1), 20);
  answer["surprises"] = Json::array({Json::array({100000, 20})});
  EXPECT_THROW(readChange(answer, "test"), std::runtime_error);
}

// By hand: label 1 lies in two columns of three cells, label 2 in one of them. One certainty was not heard.
TEST(LabelCensusTest, CountsColumnsOnce) {
  const world::GlobalLabel one{1}, two{2};
  const world::RobotId robot{0};
  const std::vector<GlobalCell> cells = {{{0, 0, 0}, one, robot, {5}, 1.f},
                                         {{0, 0, 1}, two, robot, {9}, 1.f / 63},
                                         {{0, 0, 2}, one, robot, {-3}, 0.f},
                                         {{0, 1, 0}, one, robot, {7}, 2.f / 63}};
  LabelCensus census = censusOf(cells);
  EXPECT_EQ(census, (LabelCensus{{one, {2, {7}, 65, 2}}, {two, {1, {9}, 1, 1}}}));
  add(census, {{two, {3, {4}, 10, 5}}, {world::GlobalLabel{3}, {1, {-1}, 0, 0}}});
  EXPECT_EQ(census,
            (LabelCensus{
                {one, {2, {7}, 65, 2}}, {two, {4, {9}, 11, 6}}, {world::GlobalLabel{3}, {1, {-1}, 0, 0}}}));
}

}  // namespace
}  // namespace shoal::mapping
