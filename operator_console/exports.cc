// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/exports.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "operator_console/ply.h"
#include "operator_console/render.h"
#include "shoal/mapping/area_answer.h"
#include "shoal/mapping/map_files.h"

namespace shoal::console {

const std::vector<std::string>& exportFormats() {
  static const std::vector<std::string> formats = {"csv", "labels", "geojson", "ply", "png"};
  return formats;
}

std::string exportFileName(const std::string& format) {
  return format == "labels" ? "labels.csv" : "map." + format;
}

std::string exported(const mapping::MissionView& view, const std::string& format,
                     const mapping::LabelPictures& pictures) {
  const world::Grid grid(view.cell_size_m);
  if (format == "csv") return mapping::globalMapCsv(view.map, grid);
  if (format == "labels") return mapping::labelsCsv(view.map, grid);
  if (format == "geojson") return mapping::areasGeoJson(mapping::areasOf(view)).dump() + "\n";
  if (format == "ply") return globalMapPly(view.map, grid);
  if (format == "png") {
    const std::string title = "mission " + std::to_string(view.mission);
    return encodePng(render(view.map, grid, title, {}, legendPictures(pictures)));
  }
  std::string known;
  for (const std::string& f : exportFormats()) known += (known.empty() ? "" : ", ") + f;
  throw std::invalid_argument("\"" + format + "\" is no format of a map; " + known + " are");
}

}  // namespace shoal::console
