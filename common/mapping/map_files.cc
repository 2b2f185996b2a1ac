// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/map_files.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "shoal/mapping/atomic_file.h"
#include "shoal/mapping/csv.h"
#include "shoal/mapping/piece.h"

namespace shoal::mapping {
namespace {

const std::vector<std::string> kMapColumns = {"x_m", "y_m", "z_m", "label", "robot", "seen_s", "certainty"};
const std::vector<std::string> kLabelColumns = {"label",   "name",   "cells",
                                                "area_m2", "robots", "first_seen_s"};

world::RobotId toRobot(const std::string& field, const std::string& path) {
  const auto robot = world::parseRobotId(field);
  if (!robot) throw std::runtime_error(path + ": \"" + field + "\" is not a robot; robots are R00, R01, ...");
  return *robot;
}

// The certainty that was written: steps of 1/63, as they travelled, come back to the last bit.
float certaintyFrom(double written) {
  const auto step = static_cast<float>(std::round(written * kCertaintySteps)) / kCertaintySteps;
  return std::abs(static_cast<double>(step) - written) <= 0.51e-4 ? step : static_cast<float>(written);
}

}  // namespace

std::map<world::GlobalLabel, double> areas(const GlobalMap& map, const world::Grid& grid) {
  return areasOf(censusOf(map.cells), grid);
}

std::map<world::GlobalLabel, double> areasOf(const LabelCensus& census, const world::Grid& grid) {
  std::map<world::GlobalLabel, double> areas;
  for (const auto& [label, count] : census)
    areas[label] = static_cast<double>(count.columns) * grid.cellSize() * grid.cellSize();
  return areas;
}

std::string globalMapCsv(const GlobalMap& map, const world::Grid& grid) {
  std::string csv = "x_m,y_m,z_m,label,robot,seen_s,certainty\n";
  for (const GlobalCell& c : map.cells) {
    const Eigen::Vector3d p = grid.centerOf(c.cell);
    csv += fixed(p.x(), 3) + ',' + fixed(p.y(), 3) + ',' + fixed(p.z(), 3) + ',' +
           std::to_string(number(c.label)) + ',' + name(c.robot) + ',' + fixed(c.seen.seconds(), 3) + ',' +
           fixed(c.certainty, 4) + '\n';
  }
  return csv;
}

std::string labelsCsv(const GlobalMap& map, const world::Grid& grid) {
  return labelsCsv(map.labels, areas(map, grid));
}

std::string labelsCsv(const std::vector<LabelSummary>& labels,
                      const std::map<world::GlobalLabel, double>& areas) {
  std::string csv = "label,name,cells,area_m2,robots,first_seen_s\n";
  for (const LabelSummary& row : labels) {
    std::string robots;
    for (const world::RobotId robot : row.robots) robots += (robots.empty() ? "" : ";") + name(robot);
    csv += std::to_string(number(row.label)) + ',' + mapping::quoted(row.name) + ',' +
           std::to_string(row.cells) + ',' + fixed(areas.at(row.label), 3) + ',' + robots + ',' +
           fixed(row.first_seen.seconds(), 3) + '\n';
  }
  return csv;
}

GlobalMap parseGlobalMap(const std::string& cells_csv, const std::string& labels_csv, const world::Grid& grid,
                         const std::string& origin) {
  GlobalMap map;
  const std::string cells = origin + "/global_map.csv";
  for (const auto& row : parseCsv(cells_csv, kMapColumns, cells)) {
    map.cells.push_back({grid.cellOf({toReal(row[0], cells), toReal(row[1], cells), toReal(row[2], cells)}),
                         world::GlobalLabel{static_cast<int32_t>(toInteger(row[3], cells))},
                         toRobot(row[4], cells), timeFromSeconds(toReal(row[5], cells)),
                         certaintyFrom(toReal(row[6], cells))});
  }
  std::ranges::sort(map.cells, {}, &GlobalCell::cell);
  const std::string labels = origin + "/labels.csv";
  for (const auto& row : parseCsv(labels_csv, kLabelColumns, labels)) {
    LabelSummary summary{.label = world::GlobalLabel{static_cast<int32_t>(toInteger(row[0], labels))},
                         .name = row[1],
                         .cells = toInteger(row[2], labels),
                         .robots = {},
                         .first_seen = timeFromSeconds(toReal(row[5], labels))};
    std::istringstream robots(row[4]);
    for (std::string robot; std::getline(robots, robot, ';');)
      summary.robots.push_back(toRobot(robot, labels));
    map.labels.push_back(std::move(summary));
  }
  return map;
}

GlobalMap readGlobalMap(const std::string& folder, const world::Grid& grid) {
  return parseGlobalMap(readFile(folder + "/global_map.csv"), readFile(folder + "/labels.csv"), grid, folder);
}

}  // namespace shoal::mapping
