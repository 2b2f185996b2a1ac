// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/export/geo_patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include <spdlog/fmt/fmt.h>

#include "operator_console/render.h"
#include "operator_console/xml_text.h"
#include "shoal/mapping/area_answer.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

double shortened(double degrees) { return std::round(degrees * 1e9) / 1e9; }

std::string titleOf(int64_t label, const std::string& name) {
  return name.empty() ? "label " + std::to_string(label) : name + " (" + std::to_string(label) + ")";
}

// Pairs at any depth of a list.
void toDegrees(Json& coordinates, const GeoFrame& frame) {
  if (coordinates.at(0).is_number()) {
    const auto at = frame.degreesOf(coordinates.at(0).get<double>(), coordinates.at(1).get<double>());
    coordinates = {shortened(at.longitude), shortened(at.latitude)};
    return;
  }
  for (Json& part : coordinates) toDegrees(part, frame);
}

// [west, south, east, north] of a Polygon's or MultiPolygon's outer rings.
void widen(std::array<double, 4>& box, const Json& coordinates) {
  if (coordinates.at(0).is_number()) {
    const double longitude = coordinates.at(0), latitude = coordinates.at(1);
    box = {std::min(box[0], longitude), std::min(box[1], latitude), std::max(box[2], longitude),
           std::max(box[3], latitude)};
    return;
  }
  for (const Json& part : coordinates) widen(box, part);
}

std::string ringKml(const Json& ring, const GeoFrame& frame) {
  std::string corners;
  for (const Json& corner : ring) {
    const auto at = frame.degreesOf(corner.at(0).get<double>(), corner.at(1).get<double>());
    corners += fmt::format("{}{:.9f},{:.9f}", corners.empty() ? "" : " ", at.longitude, at.latitude);
  }
  return "<LinearRing><coordinates>" + corners + "</coordinates></LinearRing>";
}

std::string placemarkKml(const Json& patch, const std::string& style, const std::string& title,
                         const GeoFrame& frame) {
  std::string robots;
  for (const Json& robot : patch.at("robots"))
    robots += (robots.empty() ? "" : " ") + robot.get<std::string>();
  std::string kml = fmt::format(
      "<Placemark><name>{}</name><description>{:.2f} m2, {:.0f} % sure, seen by {}</description>"
      "<styleUrl>#{}</styleUrl><ExtendedData>",
      xmlText(title), patch.at("area_m2").get<double>(), 100 * patch.at("certainty").get<double>(), robots,
      style);
  const auto data = [&kml](const char* key, const std::string& value) {
    kml += fmt::format("<Data name=\"{}\"><value>{}</value></Data>", key, value);
  };
  data("area_m2", fmt::format("{:.3f}", patch.at("area_m2").get<double>()));
  data("certainty", fmt::format("{:.4f}", patch.at("certainty").get<double>()));
  data("robots", robots);
  data("first_seen_s", fmt::format("{:.3f}", patch.at("first_seen_s").get<double>()));
  data("last_seen_s", fmt::format("{:.3f}", patch.at("last_seen_s").get<double>()));
  kml += "</ExtendedData><MultiGeometry>";
  for (const Json& polygon : patch.at("outline_m")) {
    kml += "<Polygon><altitudeMode>clampToGround</altitudeMode>";
    for (size_t i = 0; i < polygon.size(); ++i) {
      const char* side = i == 0 ? "outerBoundaryIs" : "innerBoundaryIs";
      kml += fmt::format("<{0}>{1}</{0}>", side, ringKml(polygon.at(i), frame));
    }
    kml += "</Polygon>";
  }
  return kml + "</MultiGeometry></Placemark>\n";
}

std::string trackKml(const std::string& robot, const std::vector<TrackPoint>& points, const GeoFrame& frame) {
  const Rgb c = robotColor(world::parseRobotId(robot).value_or(world::RobotId{0}));
  std::string kml = fmt::format(
      "<Placemark><name>{}</name><description>{} places from {:.1f} to {:.1f} "
      "s</description><Style><LineStyle>"
      "<color>ff{:02x}{:02x}{:02x}</color><width>2</width></LineStyle></Style><LineString>"
      "<altitudeMode>relativeToGround</altitudeMode><coordinates>",
      xmlText(robot), points.size(), points.front().time_s, points.back().time_s, c[2], c[1], c[0]);
  for (size_t i = 0; i < points.size(); ++i) {
    const auto at = frame.degreesOf(points[i].x, points[i].y);
    kml += fmt::format("{}{:.9f},{:.9f},{:.3f}", i == 0 ? "" : " ", at.longitude, at.latitude, points[i].z);
  }
  return kml + "</coordinates></LineString></Placemark>\n";
}

}  // namespace

std::string patchesGeoJson(const mapping::MissionView& view, const GeoFrame* frame) {
  Json geojson = mapping::areasGeoJson(mapping::areasOf(view));
  if (frame != nullptr) {
    geojson.erase("coordinates_are");
    for (Json& feature : geojson.at("features")) {
      toDegrees(feature.at("geometry").at("coordinates"), *frame);
      std::array<double, 4> box{180, 90, -180, -90};
      widen(box, feature.at("geometry").at("coordinates"));
      feature["bbox"] = box;
    }
  }
  return geojson.dump() + "\n";
}

std::string patchesStyle(const mapping::MissionView& view) {
  std::string categories, symbols;
  for (size_t i = 0; i < view.map.labels.size(); ++i) {
    const mapping::LabelSummary& row = view.map.labels[i];
    const Rgb color = colorOf(row.label);
    const int32_t number = world::number(row.label);
    categories += fmt::format(
        "      <category symbol=\"{}\" value=\"{}\" label=\"{}\" type=\"long\" render=\"true\"/>\n", i,
        number, xmlText(titleOf(number, row.name)));
    const std::string rgba = fmt::format("{},{},{},255", color[0], color[1], color[2]);
    symbols += fmt::format(
        "      <symbol name=\"{}\" type=\"fill\" alpha=\"1\" clip_to_extent=\"1\" force_rhr=\"0\">\n"
        "        <layer class=\"SimpleFill\" enabled=\"1\" locked=\"0\" pass=\"0\">\n"
        "          <Option type=\"Map\">\n"
        "            <Option name=\"color\" type=\"QString\" value=\"{}\"/>\n"
        "            <Option name=\"style\" type=\"QString\" value=\"solid\"/>\n"
        "            <Option name=\"outline_style\" type=\"QString\" value=\"no\"/>\n"
        "          </Option>\n"
        "        </layer>\n"
        "      </symbol>\n",
        i, rgba);
  }
  return "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n"
         "<qgis version=\"3.22.16\" styleCategories=\"Symbology\">\n"
         "  <renderer-v2 type=\"categorizedSymbol\" attr=\"label\" symbollevels=\"0\" enableorderby=\"0\" "
         "forceraster=\"0\">\n"
         "    <categories>\n" +
         categories + "    </categories>\n    <symbols>\n" + symbols +
         "    </symbols>\n  </renderer-v2>\n  <layerGeometryType>2</layerGeometryType>\n</qgis>\n";
}

std::string patchesKml(const mapping::MissionView& view,
                       const std::map<std::string, std::vector<TrackPoint>>& tracks, const GeoFrame& frame) {
  std::string kml = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml "
      "xmlns=\"http://www.opengis.net/kml/2.2\">\n<Document>\n"
      "<name>mission {}</name>\n",
      view.mission);
  for (const mapping::LabelSummary& row : view.map.labels) {
    const Rgb c = colorOf(row.label);
    kml += fmt::format(
        "<Style "
        "id=\"label{}\"><LineStyle><width>0</width></LineStyle><PolyStyle><color>ff{:02x}{:02x}{:02x}</color>"
        "<outline>0</outline></PolyStyle></Style>\n",
        world::number(row.label), c[2], c[1], c[0]);
  }
  for (const Json& area : mapping::areasOf(view)) {
    const auto label = area.at("label").get<int64_t>();
    const std::string title = titleOf(label, area.at("name").get<std::string>());
    kml += "<Folder><name>" + xmlText(title) + "</name>\n";
    for (const Json& patch : area.at("patches"))
      kml += placemarkKml(patch, "label" + std::to_string(label), title, frame);
    kml += "</Folder>\n";
  }
  kml += "<Folder><name>robots</name>\n";
  for (const mapping::NodeStatus& node : view.nodes) {
    if (node.phase == "node" || node.observation < 0) continue;
    const auto at = frame.degreesOf(node.x_m, node.y_m);
    kml += fmt::format(
        "<Placemark><name>{}</name><description>{}, heard at {:.1f} "
        "s</description><Point><coordinates>{:.9f},{:.9f}"
        "</coordinates></Point></Placemark>\n",
        xmlText(node.name), xmlText(node.phase), node.heard_s, at.longitude, at.latitude);
  }
  kml += "</Folder>\n";
  if (!tracks.empty()) kml += "<Folder><name>tracks</name>\n";
  for (const auto& [robot, points] : tracks) kml += trackKml(robot, points, frame);
  if (!tracks.empty()) kml += "</Folder>\n";
  return kml + "</Document>\n</kml>\n";
}

}  // namespace shoal::console
