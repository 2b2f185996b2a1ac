// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/exports.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <spdlog/spdlog.h>

#include "operator_console/export/geo_patches.h"
#include "operator_console/export/geotiff.h"
#include "operator_console/export/mcap_export.h"
#include "operator_console/export/octree.h"
#include "operator_console/label_pictures.h"
#include "operator_console/ply.h"
#include "operator_console/render.h"
#include "operator_console/robot_tracks.h"
#include "shoal/mapping/map_files.h"

namespace shoal::console {
namespace {

using Origin = ExportFormat::Origin;

std::string pngOf(const Where& where, const mapping::MissionView& view) {
  const std::string title = "mission " + std::to_string(view.mission);
  return encodePng(
      render(view.map, world::Grid(view.cell_size_m), title, {}, legendPictures(picturesAt(where))));
}

std::string mcapOf(const Where& where, const mapping::MissionView& view, const GeoFrame* frame) {
  nlohmann::ordered_json events;
  try {
    events = ask(where, {{"query", "events"}});
  } catch (const std::runtime_error&
               error) {  // a run without its robots' files, say: the map is there all the same
    spdlog::warn("no events: {}", error.what());
  }
  return missionMcap(view, picturesAt(where), events, frame);
}

std::map<std::string, std::vector<TrackPoint>> tracksIfAny(const Where& where) {
  try {
    return tracksOf(where);
  } catch (const std::runtime_error& error) {  // the map is there all the same
    spdlog::warn("no tracks: {}", error.what());
    return {};
  }
}

std::vector<ExportedFile> filesOf(const Where& where, const mapping::MissionView& view,
                                  const std::string& format, const std::string& file, const GeoFrame* frame) {
  const std::string stem = std::filesystem::path(file).stem();
  const world::Grid grid(view.cell_size_m);
  if (format == "csv") return {{file, mapping::globalMapCsv(view.map, grid)}};
  if (format == "labels") return {{file, mapping::labelsCsv(view.map, grid)}};
  if (format == "geojson") return {{file, patchesGeoJson(view, frame)}, {stem + ".qml", patchesStyle(view)}};
  if (format == "geotiff") {
    return {{file, labelsGeoTiff(view, frame)},
            {file + ".aux.xml", geotiffLegend(view)},
            {stem + "_certainty.tif", certaintyGeoTiff(view, frame)}};
  }
  if (format == "kml") return {{file, patchesKml(view, tracksIfAny(where), *frame)}};
  if (format == "ply") return {{file, globalMapPly(view.map, grid)}};
  if (format == "octree") return {{file, colorOcTree(view)}};
  if (format == "mcap") return {{file, mcapOf(where, view, frame)}};
  return {{file, pngOf(where, view)}};
}

}  // namespace

const std::vector<ExportFormat>& exportFormats() {
  static const std::vector<ExportFormat> formats = {
      {"csv", "map.csv", "cells as a table"},
      {"labels", "labels.csv", "the legend as a table"},
      {"geojson", "map.geojson", "patches as polygons, with a style for QGIS", {"map.qml"}, Origin::kTaken},
      {"geotiff",
       "map.tif",
       "labels and certainty as pictures for QGIS and GDAL",
       {"map.tif.aux.xml", "map_certainty.tif"},
       Origin::kTaken},
      {"kml", "map.kml", "patches and tracks for Google Earth", {}, Origin::kNeeded},
      {"ply", "map.ply", "points for CloudCompare and MeshLab"},
      {"octree", "map.ot", "a coloured OctoMap"},
      {"mcap",
       "map.mcap",
       "map, robots, pictures and events for Foxglove and Lichtblick",
       {},
       Origin::kTaken},
      {"png", "map.png", "a picture with its legend"},
  };
  return formats;
}

const ExportFormat& exportFormat(const std::string& name) {
  const auto found = std::ranges::find(exportFormats(), name, &ExportFormat::name);
  if (found != exportFormats().end()) return *found;
  std::string known;
  for (const ExportFormat& f : exportFormats()) known += (known.empty() ? "" : ", ") + f.name;
  throw std::invalid_argument("\"" + name + "\" is no format of a map; " + known + " are");
}

Export exported(const Where& where, const std::string& format, const std::string& file,
                const std::optional<GeoOrigin>& origin) {
  const Origin wants = exportFormat(format).origin;
  if (origin && wants == Origin::kNone)
    throw std::invalid_argument(format + " is in metres of the mission frame: it takes no origin on Earth");
  if (!origin && wants == Origin::kNeeded)
    throw std::invalid_argument(format + " is in degrees: say where (0, 0) was, --origin LATITUDE LONGITUDE");
  std::optional<GeoFrame> earth;
  if (origin) earth.emplace(*origin);
  const GeoFrame* frame = earth ? &*earth : nullptr;
  const mapping::MissionView view = viewOf(where);
  return {filesOf(where, view, format, file, frame), view.map.cells.size(), view.map.labels.size()};
}

}  // namespace shoal::console
