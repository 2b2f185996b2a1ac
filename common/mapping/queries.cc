// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/queries.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "shoal/mapping/map_files.h"
#include "shoal/rounded.h"

namespace shoal::mapping {
namespace {

using Json = nlohmann::ordered_json;

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
          {"class_bytes", n.class_bytes},
          {"budget", n.budget},
          {"queue_bytes", n.queue_bytes},
          {"clear_s", rounded(n.clear_s, 1e1)},
          {"ms_per_frame", rounded(n.ms_per_frame, 1e2)},
          {"position_m", {rounded(n.x_m, 1e3), rounded(n.y_m, 1e3), rounded(n.z_m, 1e3)}},
          {"rejected", n.rejected},
          {"conflicts", n.conflicts},
          {"clock_skew_s", n.clock_skew_s ? Json(rounded(*n.clock_skew_s, 1e3)) : Json()},
          {"settings", n.settings},
          {"heard_share", n.heard_share ? Json(rounded(*n.heard_share, 1e3)) : Json()},
          {"battery_percent", n.battery_percent ? Json(*n.battery_percent) : Json()},
          {"depth_m", n.depth_m ? Json(rounded(*n.depth_m, 1e2)) : Json()},
          {"heard_whole", n.heard_whole},
          {"agreement", n.agreement}};
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
  n.clear_s = json.value("clear_s", 0.0);
  json.at("ms_per_frame").get_to(n.ms_per_frame);
  json.at("position_m").at(0).get_to(n.x_m);
  json.at("position_m").at(1).get_to(n.y_m);
  json.at("position_m").at(2).get_to(n.z_m);
  json.at("rejected").get_to(n.rejected);
  json.at("conflicts").get_to(n.conflicts);
  json.at("heard_whole").get_to(n.heard_whole);
  n.agreement = json.value("agreement", "none");  // runs of older builds do not say
  n.settings = json.value("settings", "none");
  const auto number = [&json](const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_number() ? std::optional(found->get<double>()) : std::nullopt;
  };
  n.clock_skew_s = number("clock_skew_s");
  n.heard_share = number("heard_share");
  n.depth_m = number("depth_m");
  if (const auto percent = number("battery_percent")) n.battery_percent = static_cast<int>(*percent);
  if (const auto classes = json.find("class_bytes"); classes != json.end()) classes->get_to(n.class_bytes);
  return n;
}

Json statusAnswer(const MissionView& view) { return statusAnswer(view, std::ssize(view.map.cells)); }

Json statusAnswer(const MissionView& view, int64_t num_cells) {
  Json answer{{"mission_id", view.mission},
              {"cell_size_m", view.cell_size_m},
              {"cells", num_cells},
              {"labels", view.map.labels.size()},
              {"digest", {{"state", digestText(view.state_digest)}, {"map", digestText(view.map_digest)}}},
              {"nodes", Json::array()}};
  for (const NodeStatus& n : view.nodes) answer["nodes"].push_back(toJson(n));
  answer["strangers"] = Json::array();
  for (const StrangerStatus& s : view.strangers)
    answer["strangers"].push_back({{"name", s.name}, {"has", s.has}, {"messages", s.messages}});
  answer["mixed"] = Json::array();
  for (const Mixture& m : view.mixed)
    answer["mixed"].push_back({{"kind", m.kind}, {"node", m.node}, {"says", m.says}});
  return answer;
}

Json labelsAnswer(const MissionView& view) {
  return {{"labels", labelRows(view.map.labels, censusOf(view.map.cells), world::Grid(view.cell_size_m))}};
}

Json labelRows(const std::vector<LabelSummary>& labels, const LabelCensus& census, const world::Grid& grid) {
  const auto area = areasOf(census, grid);
  Json rows = Json::array();
  for (const LabelSummary& row : labels) {
    Json robots = Json::array();
    for (const world::RobotId robot : row.robots) robots.push_back(name(robot));
    const auto found = census.find(row.label);
    const LabelCount count = found == census.end() ? LabelCount{} : found->second;
    const double sure = static_cast<double>(std::max<int64_t>(count.sure, 1));
    rows.push_back(
        {{"label", number(row.label)},
         {"name", row.name},
         {"cells", row.cells},
         {"area_m2", rounded(found == census.end() ? 0.0 : area.at(row.label), 1e3)},
         {"robots", std::move(robots)},
         {"first_seen_s", rounded(row.first_seen.seconds(), 1e3)},
         {"last_seen_s", rounded(count.last_seen.seconds(), 1e3)},
         {"certainty", rounded(static_cast<double>(count.certainty) / kCertaintySteps / sure, 1e4)}});
  }
  return rows;
}

namespace {

struct Opinion {
  world::RobotId robot{};
  world::TopicId topic{};
  world::Timestamp seen;
  uint8_t steps = 0;  // certainty x kCertaintySteps, 0 while unheard
};

// What every robot said of the cells of one column, newest first as the map ranks them.
std::map<world::CellIndex, std::vector<Opinion>> opinionsOn(const BeliefStore& beliefs,
                                                            const world::CellIndex& column) {
  std::map<world::CellIndex, std::vector<Opinion>> opinions;
  const auto here = [&column](const world::CellIndex& c) { return c.x == column.x && c.y == column.y; };
  beliefs.visit([&](const Piece& piece) {  // a robot's bricks before its certainties
    if (const auto* brick = std::get_if<BrickPart>(&piece.content)) {
      for (const BrickCell& c : brick->cells)
        if (here(c.cell)) opinions[c.cell].push_back({piece.key.robot, c.topic, c.seen});
    } else if (const auto* part = std::get_if<CertaintyPart>(&piece.content)) {
      for (const CertaintyCell& c : part->cells) {
        if (!here(c.cell) || !opinions.contains(c.cell)) continue;
        for (Opinion& o : opinions[c.cell])
          if (o.robot == piece.key.robot) o.steps = c.steps;
      }
    }
  });
  for (auto& [cell, list] : opinions) {
    std::ranges::sort(list, std::greater<>(), [](const Opinion& o) { return std::pair(o.seen, o.robot); });
  }
  return opinions;
}

}  // namespace

Json atAnswer(const MissionView& view, const BeliefStore& beliefs, double x_m, double y_m) {
  const world::Grid grid(view.cell_size_m);
  const double farthest = view.cell_size_m * (INT32_MAX - 1);  // cells have 32-bit indices
  const bool is_near = std::abs(x_m) <= farthest && std::abs(y_m) <= farthest;
  const world::CellIndex column = is_near ? grid.cellOf({x_m, y_m, 0}) : world::CellIndex{};
  std::map<std::pair<world::RobotId, world::TopicId>, world::GlobalLabel> label_of;
  for (const Correspondence& k : view.map.correspondences) label_of[{k.robot, k.topic}] = k.label;
  const auto opinions = is_near ? opinionsOn(beliefs, column) : decltype(opinionsOn(beliefs, column)){};
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
              {"certainty", rounded(c.certainty, 1e4)},
              {"history", Json::array()}};
    for (const LabelSummary& row : view.map.labels)
      if (row.label == c.label) cell["name"] = row.name;
    const auto told = opinions.find(c.cell);
    for (const Opinion& o : told == opinions.end() ? std::vector<Opinion>{} : told->second) {
      const auto known = label_of.find({o.robot, o.topic});
      const auto label = known == label_of.end() ? world::globalLabel(o.robot, o.topic) : known->second;
      cell["history"].push_back({{"robot", name(o.robot)},
                                 {"topic", number(o.topic)},
                                 {"label", number(label)},
                                 {"seen_s", rounded(o.seen.seconds(), 1e3)},
                                 {"certainty", rounded(static_cast<float>(o.steps) / kCertaintySteps, 1e4)}});
    }
    cells.push_back(std::move(cell));
  }
  return {{"x_m", x_m}, {"y_m", y_m}, {"cells", std::move(cells)}};
}

}  // namespace shoal::mapping
