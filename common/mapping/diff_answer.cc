// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/diff_answer.h"

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "shoal/demand.h"
#include "shoal/mapping/csv.h"
#include "shoal/mapping/map_files.h"
#include "shoal/rounded.h"

namespace shoal::mapping {
namespace {

using Json = nlohmann::ordered_json;

struct Count {
  int64_t appeared = 0, seen = 0, relabelled = 0, gone = 0;
  int64_t& of(const std::string& change) {
    if (change == "appeared") return appeared;
    if (change == "seen") return seen;
    if (change == "relabelled") return relabelled;
    SHOAL_DEMAND(change == "gone");
    return gone;
  }
  Json json() const {
    return {{"appeared", appeared}, {"seen", seen}, {"relabelled", relabelled}, {"gone", gone}};
  }
};

// Walks both maps, which ascend by cell, and visits (before or null, after or null) of every cell.
template <typename Visit>
void walk(const GlobalMap& before, const GlobalMap& after, Visit&& visit) {
  auto b = before.cells.begin();
  auto a = after.cells.begin();
  while (b != before.cells.end() || a != after.cells.end()) {
    if (a == after.cells.end() || (b != before.cells.end() && b->cell < a->cell)) {
      visit(&*b++, nullptr);
    } else if (b == before.cells.end() || a->cell < b->cell) {
      visit(nullptr, &*a++);
    } else {
      visit(&*b++, &*a++);
    }
  }
}

std::string changeOf(const GlobalCell* before, const GlobalCell* after) {
  if (before == nullptr) return "appeared";
  if (after == nullptr) return "gone";
  if (before->label == after->label) return "";
  return before->seen == after->seen && before->robot == after->robot ? "relabelled" : "seen";
}

Json labelsJson(const MissionView& before, const MissionView& after) {
  struct Ground {
    std::string name;
    double before_m2 = 0, after_m2 = 0;
  };
  std::map<world::GlobalLabel, Ground> labels;
  for (const auto& [label, m2] : areas(before.map, world::Grid(before.cell_size_m)))
    labels[label].before_m2 = m2;
  for (const auto& [label, m2] : areas(after.map, world::Grid(after.cell_size_m)))
    labels[label].after_m2 = m2;
  for (const MissionView* view : {&before, &after})
    for (const LabelSummary& row : view->map.labels) labels[row.label].name = row.name;
  Json rows = Json::array();
  for (const auto& [label, ground] : labels) {
    rows.push_back({{"label", number(label)},
                    {"name", ground.name},
                    {"area_before_m2", rounded(ground.before_m2, 1e3)},
                    {"area_after_m2", rounded(ground.after_m2, 1e3)}});
  }
  return rows;
}

}  // namespace

Json diffAnswer(const MissionView& before, double before_s, const MissionView& after, double after_s) {
  const world::Grid grid(after.cell_size_m);
  Json changes = Json::array();
  Count total;
  std::map<world::RobotId, Count> by_robot;
  walk(before.map, after.map, [&](const GlobalCell* was, const GlobalCell* is) {
    const std::string change = changeOf(was, is);
    if (change.empty()) return;
    const GlobalCell& shown = is != nullptr ? *is : *was;
    ++total.of(change);
    ++by_robot[shown.robot].of(change);
    const Eigen::Vector3d p = grid.centerOf(shown.cell);
    changes.push_back({{"x_m", rounded(p.x(), 1e3)},
                       {"y_m", rounded(p.y(), 1e3)},
                       {"z_m", rounded(p.z(), 1e3)},
                       {"change", change},
                       {"before", was != nullptr ? Json(number(was->label)) : Json()},
                       {"after", is != nullptr ? Json(number(is->label)) : Json()},
                       {"robot", name(shown.robot)},
                       {"seen_s", rounded(shown.seen.seconds(), 1e3)}});
  });
  Json robots = Json::array();
  for (const auto& [robot, count] : by_robot) {
    Json row = {{"robot", name(robot)}};
    row.update(count.json());
    robots.push_back(std::move(row));
  }
  return {{"before_s", rounded(before_s, 1e3)},
          {"after_s", rounded(after_s, 1e3)},
          {"cells_before", before.map.cells.size()},
          {"cells_after", after.map.cells.size()},
          {"total", total.json()},
          {"robots", std::move(robots)},
          {"labels", labelsJson(before, after)},
          {"changes", std::move(changes)}};
}

std::string diffCsv(const Json& diff) {
  std::string csv = "x_m,y_m,z_m,change,before,after,robot,seen_s\n";
  const auto label = [](const Json& l) { return l.is_null() ? "" : std::to_string(l.get<int64_t>()); };
  for (const Json& c : diff.at("changes")) {
    csv += fixed(c.at("x_m").get<double>(), 3) + ',' + fixed(c.at("y_m").get<double>(), 3) + ',' +
           fixed(c.at("z_m").get<double>(), 3) + ',' + c.at("change").get<std::string>() + ',' +
           label(c.at("before")) + ',' + label(c.at("after")) + ',' + c.at("robot").get<std::string>() + ',' +
           fixed(c.at("seen_s").get<double>(), 3) + '\n';
  }
  return csv;
}

}  // namespace shoal::mapping
