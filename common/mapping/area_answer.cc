// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/area_answer.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "shoal/mapping/csv.h"
#include "shoal/mapping/outline.h"
#include "shoal/rounded.h"

namespace shoal::mapping {
namespace {

using Json = nlohmann::ordered_json;

Json ringJson(const Ring& ring, double cell_size_m) {
  Json corners = Json::array();
  const auto add = [&](const Corner& c) {
    corners.push_back({rounded((static_cast<double>(c.first) - 0.5) * cell_size_m, 1e3),
                       rounded((static_cast<double>(c.second) - 0.5) * cell_size_m, 1e3)});
  };
  for (const Corner& c : ring) add(c);
  add(ring.front());
  return corners;
}

Json outlineJson(const Patch& patch, double cell_size_m) {
  Json polygons = Json::array();
  for (const Polygon& polygon : outlineOf(patch.columns)) {
    Json rings = {ringJson(polygon.outer, cell_size_m)};
    for (const Ring& hole : polygon.holes) rings.push_back(ringJson(hole, cell_size_m));
    polygons.push_back(std::move(rings));
  }
  return polygons;
}

Json patchJson(const Patch& patch, double cell_size_m) {
  Json robots = Json::array();
  for (const world::RobotId robot : patch.robots) robots.push_back(name(robot));
  return {{"area_m2", rounded(patch.area_m2, 1e3)},
          {"cells", patch.cells},
          {"centroid_m", {rounded(patch.x_m, 1e3), rounded(patch.y_m, 1e3)}},
          {"box_m",
           {rounded(patch.min_x_m, 1e3), rounded(patch.min_y_m, 1e3), rounded(patch.max_x_m, 1e3),
            rounded(patch.max_y_m, 1e3)}},
          {"robots", std::move(robots)},
          {"first_seen_s", rounded(patch.first_seen.seconds(), 1e3)},
          {"last_seen_s", rounded(patch.last_seen.seconds(), 1e3)},
          {"certainty", rounded(patch.certainty, 1e4)},
          {"outline_m", outlineJson(patch, cell_size_m)}};
}

Json areaOf(const MissionView& view, const LabelSummary& row, const PatchFilter& filter) {
  Json patches = Json::array();
  double area_m2 = 0;
  for (const Patch& patch : patchesOf(view.map, world::Grid(view.cell_size_m), row.label, filter)) {
    area_m2 += patch.area_m2;
    patches.push_back(patchJson(patch, view.cell_size_m));
  }
  return {{"label", number(row.label)},
          {"name", row.name},
          {"min_m2", filter.min_m2},
          {"since_s", filter.since ? Json(rounded(filter.since->seconds(), 1e3)) : Json()},
          {"least_certainty", filter.certainty},
          {"area_m2", rounded(area_m2, 1e3)},
          {"patches", std::move(patches)}};
}

std::string joined(const Json& list) {
  std::string text;
  for (const Json& item : list) text += (text.empty() ? "" : ";") + item.get<std::string>();
  return text;
}

}  // namespace

std::optional<world::GlobalLabel> labelNamed(const GlobalMap& map, const std::string& text) {
  int32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = error == std::errc{} && end == text.data() + text.size();
  std::optional<world::GlobalLabel> found;
  for (const LabelSummary& row : map.labels) {
    if (is_number && number(row.label) == value) return row.label;
    if (row.name.empty() || row.name != text) continue;
    if (found) return std::nullopt;
    found = row.label;
  }
  return found;
}

std::string noSuchLabel(const GlobalMap& map, const std::string& text) {
  std::vector<const LabelSummary*> rows;
  for (const LabelSummary& row : map.labels) rows.push_back(&row);
  std::ranges::stable_sort(rows, std::greater<>(), &LabelSummary::cells);
  const auto same_name = std::ranges::count(rows, text, &LabelSummary::name);
  std::string said = same_name > 1 ? std::to_string(same_name) + " labels are called \"" + text + "\""
                                   : "the map has no label \"" + text + "\"";
  if (rows.empty()) return said + "; it has none at all";
  said += same_name > 1 ? "; give the number of one:" : "; the largest are";
  size_t told = 0;
  for (const LabelSummary* row : rows) {
    if (same_name > 1 && row->name != text) continue;
    if (told++ == 8) break;
    said += (told == 1 ? " " : ", ") + std::to_string(number(row->label));
    if (!row->name.empty() && same_name <= 1) said += " \"" + row->name + "\"";
  }
  return said;
}

Json areaAnswer(const MissionView& view, const std::string& label, const PatchFilter& filter) {
  const auto found = labelNamed(view.map, label);
  if (!found) return {{"error", noSuchLabel(view.map, label)}};
  return areaOf(view, *std::ranges::find(view.map.labels, *found, &LabelSummary::label), filter);
}

Json areasOf(const MissionView& view) {
  Json areas = Json::array();
  for (const LabelSummary& row : view.map.labels) areas.push_back(areaOf(view, row, {}));
  return areas;
}

std::string areaCsv(const Json& area) {
  std::string csv =
      "label,name,patch,area_m2,cells,x_m,y_m,min_x_m,min_y_m,max_x_m,max_y_m,robots,"
      "first_seen_s,last_seen_s,certainty\n";
  int64_t patch_number = 0;
  for (const Json& p : area.at("patches")) {
    const auto metres = [&p](const char* key, size_t i) { return fixed(p.at(key).at(i).get<double>(), 3); };
    const auto real = [&p](const char* key, int digits) { return fixed(p.at(key).get<double>(), digits); };
    csv += std::to_string(area.at("label").get<int64_t>()) + ',' +
           mapping::quoted(area.at("name").get<std::string>()) + ',' + std::to_string(++patch_number) + ',' +
           real("area_m2", 3) + ',' + std::to_string(p.at("cells").get<int64_t>()) + ',' +
           metres("centroid_m", 0) + ',' + metres("centroid_m", 1);
    for (size_t i = 0; i < 4; ++i) csv += ',' + metres("box_m", i);
    csv += ',' + joined(p.at("robots")) + ',' + real("first_seen_s", 3) + ',' + real("last_seen_s", 3) + ',' +
           real("certainty", 4) + '\n';
  }
  return csv;
}

Json areasGeoJson(const Json& areas) {
  Json features = Json::array();
  for (const Json& area : areas) {
    for (const Json& p : area.at("patches")) {
      const Json& outline = p.at("outline_m");
      Json geometry = outline.size() == 1 ? Json{{"type", "Polygon"}, {"coordinates", outline.at(0)}}
                                          : Json{{"type", "MultiPolygon"}, {"coordinates", outline}};
      Json properties = {{"label", area.at("label")}, {"name", area.at("name")}};
      for (const char* key : {"area_m2", "cells", "robots", "first_seen_s", "last_seen_s", "certainty"}) {
        properties[key] = p.at(key);
      }
      features.push_back({{"type", "Feature"},
                          {"bbox", p.at("box_m")},
                          {"geometry", std::move(geometry)},
                          {"properties", std::move(properties)}});
    }
  }
  return {{"type", "FeatureCollection"},
          {"coordinates_are", "X, Y in metres of the mission frame, not longitude and latitude"},
          {"features", std::move(features)}};
}

}  // namespace shoal::mapping
