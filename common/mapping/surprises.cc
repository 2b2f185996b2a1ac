// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/surprises.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "shoal/mapping/csv.h"
#include "shoal/mapping/patches.h"
#include "shoal/rounded.h"

namespace shoal::mapping {
namespace {

using Json = nlohmann::ordered_json;

// The patches of cells whatever their labels.
std::vector<Patch> placesOf(const std::vector<SurprisingCell>& cells, const world::Grid& grid) {
  constexpr world::GlobalLabel kAny{0};
  GlobalMap alone;
  for (const SurprisingCell& c : cells) {
    alone.cells.push_back(c.cell);
    alone.cells.back().label = kAny;
  }
  return patchesOf(alone, grid, kAny);
}

}  // namespace

std::vector<SurprisingCell> surprisesOf(const GlobalMap& map, const BeliefStore& beliefs) {
  std::vector<SurprisingCell> cells;
  for (const world::RobotId robot : beliefs.robots()) {
    std::map<world::CellIndex, uint8_t> told;  // parts in order: the last one's word counts
    beliefs.visitOf(robot, [&](const Piece& piece) {
      const auto* part = std::get_if<CertaintyPart>(&piece.content);
      if (part == nullptr) return;
      for (const CertaintyCell& c : part->cells)
        if (c.surprise > 0) told[c.cell] = c.surprise;
    });
    for (const auto& [index, steps] : told) {
      const auto cell = std::ranges::lower_bound(map.cells, index, {}, &GlobalCell::cell);
      if (cell == map.cells.end() || cell->cell != index || cell->robot != robot) continue;
      cells.push_back({*cell, static_cast<float>(steps) / kSurpriseStepsPerUnit});
    }
  }
  std::ranges::sort(cells, {}, [](const SurprisingCell& c) { return c.cell.cell; });
  return cells;
}

std::string surprisesCsv(const std::vector<SurprisingCell>& cells, const world::Grid& grid) {
  std::string csv = "x_m,y_m,z_m,label,robot,seen_s,surprise\n";
  for (const auto& [c, surprise] : cells) {
    const Eigen::Vector3d p = grid.centerOf(c.cell);
    csv += fixed(p.x(), 3) + ',' + fixed(p.y(), 3) + ',' + fixed(p.z(), 3) + ',' +
           std::to_string(number(c.label)) + ',' + name(c.robot) + ',' + fixed(c.seen.seconds(), 3) + ',' +
           fixed(static_cast<double>(surprise), 3) + '\n';
  }
  return csv;
}

Json surprisesAnswer(const MissionView& view, const BeliefStore& beliefs, double least) {
  if (!(std::isfinite(least) && least >= 0))
    throw std::invalid_argument("the least surprise must be 0 or more, got " + std::to_string(least));
  const world::Grid grid(view.cell_size_m);
  std::vector<SurprisingCell> cells = surprisesOf(view.map, beliefs);
  std::erase_if(cells, [&](const SurprisingCell& c) { return static_cast<double>(c.surprise) < least; });
  std::map<Column, const SurprisingCell*> most;  // of each column, the lowest among equals
  for (const SurprisingCell& c : cells) {
    const SurprisingCell*& known = most[{c.cell.cell.x, c.cell.cell.y}];
    if (known == nullptr || known->surprise < c.surprise) known = &c;
  }
  std::vector<std::pair<Patch, const SurprisingCell*>> places;
  for (Patch& patch : placesOf(cells, grid)) {
    const SurprisingCell* peak = nullptr;
    for (const Column& column : patch.columns) {
      const SurprisingCell* c = most.at(column);
      if (peak == nullptr || peak->surprise < c->surprise) peak = c;
    }
    places.emplace_back(std::move(patch), peak);
  }
  std::ranges::stable_sort(places, std::greater<>(), [](const auto& p) { return p.second->surprise; });

  std::map<world::GlobalLabel, std::string> names;
  for (const LabelSummary& row : view.map.labels) names[row.label] = row.name;
  Json answer{{"cells", cells.size()}, {"least", least}, {"places", Json::array()}};
  for (const auto& [patch, peak] : places) {
    const Eigen::Vector3d p = grid.centerOf(peak->cell.cell);
    Json robots = Json::array();
    for (const world::RobotId robot : patch.robots) robots.push_back(name(robot));
    answer["places"].push_back({{"x_m", rounded(p.x(), 1e3)},
                                {"y_m", rounded(p.y(), 1e3)},
                                {"z_m", rounded(p.z(), 1e3)},
                                {"surprise", rounded(peak->surprise, 1e3)},
                                {"label", number(peak->cell.label)},
                                {"name", names[peak->cell.label]},
                                {"cells", patch.cells},
                                {"area_m2", rounded(patch.area_m2, 1e3)},
                                {"robots", std::move(robots)},
                                {"first_seen_s", rounded(patch.first_seen.seconds(), 1e3)},
                                {"last_seen_s", rounded(patch.last_seen.seconds(), 1e3)}});
  }
  return answer;
}

}  // namespace shoal::mapping
