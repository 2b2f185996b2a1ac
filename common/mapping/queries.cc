// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/queries.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "shoal/mapping/map_files.h"

namespace shoal::mapping {
namespace {

using Json = nlohmann::ordered_json;

double rounded(double value, double per_unit) { return std::round(value * per_unit) / per_unit; }

}  // namespace

std::string digestText(uint64_t digest) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(digest));
  return text;
}

Json toJson(const NodeStatus& n) {
  return {{"name", n.name},
          {"phase", n.phase},
          {"heard_s", rounded(n.heard_s, 1e3)},
          {"observation", n.observation},
          {"num_observations", n.num_observations},
          {"topics", n.topics},
          {"cells", n.cells},
          {"bytes_sent", n.bytes_sent},
          {"budget", n.budget},
          {"queue_bytes", n.queue_bytes},
          {"ms_per_frame", rounded(n.ms_per_frame, 1e2)},
          {"position_m", {rounded(n.x_m, 1e3), rounded(n.y_m, 1e3), rounded(n.z_m, 1e3)}},
          {"rejected", n.rejected},
          {"conflicts", n.conflicts},
          {"heard_whole", n.heard_whole}};
}

NodeStatus nodeFromJson(const Json& json) {
  NodeStatus n;
  json.at("name").get_to(n.name);
  json.at("phase").get_to(n.phase);
  json.at("heard_s").get_to(n.heard_s);
  json.at("observation").get_to(n.observation);
  json.at("num_observations").get_to(n.num_observations);
  json.at("topics").get_to(n.topics);
  json.at("cells").get_to(n.cells);
  json.at("bytes_sent").get_to(n.bytes_sent);
  json.at("budget").get_to(n.budget);
  json.at("queue_bytes").get_to(n.queue_bytes);
  json.at("ms_per_frame").get_to(n.ms_per_frame);
  json.at("position_m").at(0).get_to(n.x_m);
  json.at("position_m").at(1).get_to(n.y_m);
  json.at("position_m").at(2).get_to(n.z_m);
  json.at("rejected").get_to(n.rejected);
  json.at("conflicts").get_to(n.conflicts);
  json.at("heard_whole").get_to(n.heard_whole);
  return n;
}

Json statusAnswer(const MissionView& view) {
  Json answer{{"mission_id", view.mission},
              {"cell_size_m", view.cell_size_m},
              {"cells", view.map.cells.size()},
              {"labels", view.map.labels.size()},
              {"digest", {{"state", digestText(view.state_digest)}, {"map", digestText(view.map_digest)}}},
              {"nodes", Json::array()}};
  for (const NodeStatus& n : view.nodes) answer["nodes"].push_back(toJson(n));
  return answer;
}

Json labelsAnswer(const MissionView& view) {
  const auto area = areas(view.map, world::Grid(view.cell_size_m));
  Json rows = Json::array();
  for (const LabelSummary& row : view.map.labels) {
    Json robots = Json::array();
    for (const world::RobotId robot : row.robots) robots.push_back(name(robot));
    const auto covered = area.find(row.label);
    rows.push_back({{"label", number(row.label)},
                    {"name", row.name},
                    {"cells", row.cells},
                    {"area_m2", rounded(covered == area.end() ? 0.0 : covered->second, 1e3)},
                    {"robots", std::move(robots)},
                    {"first_seen_s", rounded(row.first_seen.seconds(), 1e3)}});
  }
  return {{"labels", std::move(rows)}};
}

Json atAnswer(const MissionView& view, double x_m, double y_m) {
  const world::Grid grid(view.cell_size_m);
  const double farthest = view.cell_size_m * (INT32_MAX - 1);  // cells have 32-bit indices
  const bool is_near = std::abs(x_m) <= farthest && std::abs(y_m) <= farthest;
  const world::CellIndex column = is_near ? grid.cellOf({x_m, y_m, 0}) : world::CellIndex{};
  Json cells = Json::array();
  for (const GlobalCell& c : view.map.cells) {
    if (!is_near || c.cell.x != column.x || c.cell.y != column.y) continue;
    const Eigen::Vector3d p = grid.centerOf(c.cell);
    Json cell{{"x_m", rounded(p.x(), 1e3)},
              {"y_m", rounded(p.y(), 1e3)},
              {"z_m", rounded(p.z(), 1e3)},
              {"label", number(c.label)},
              {"name", ""},
              {"robot", name(c.robot)},
              {"seen_s", rounded(c.seen.seconds(), 1e3)},
              {"certainty", rounded(c.certainty, 1e4)}};
    for (const LabelSummary& row : view.map.labels)
      if (row.label == c.label) cell["name"] = row.name;
    cells.push_back(std::move(cell));
  }
  return {{"x_m", x_m}, {"y_m", y_m}, {"cells", std::move(cells)}};
}

}  // namespace shoal::mapping
