// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/label_pictures.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "operator_console/recorded_mission.h"
#include "shoal/mapping/atomic_file.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

Json indexOf(const std::string& dir) {
  const std::string path = dir + "/pictures/pictures.json";
  if (!std::filesystem::exists(path)) return {{"labels", Json::array()}};
  try {
    return Json::parse(mapping::readFile(path));
  } catch (const Json::exception& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
}

// As the answer to "pictures"; of a run with the names of files.
Json picturesJson(const Where& where) {
  if (!where.run.empty()) return indexOf(where.run);
  return ask(where, {{"query", "pictures"}});
}

}  // namespace

mapping::LabelPictures picturesOfRun(const std::string& dir) { return mapping::picturesFrom(indexOf(dir)); }

mapping::LabelPictures picturesAt(const Where& where) { return mapping::picturesFrom(picturesJson(where)); }

void addPictures(const Where& where, Json& labels) {
  const Json pictures = picturesJson(where);
  for (Json& row : labels) {
    row["pictures"] = Json::array();
    for (const Json& of_label : pictures.value("labels", Json::array())) {
      if (of_label.at("label") != row.at("label")) continue;
      for (const Json& p : of_label.at("pictures")) {
        row["pictures"].push_back({{"robot", p.at("robot")},
                                   {"topic", p.at("topic")},
                                   {"example", p.at("example")},
                                   {"seen_s", p.at("seen_s")},
                                   {"layers", p.at("layers").size()},
                                   {"num_layers", p.at("num_layers")}});
        if (p.contains("file"))
          row["pictures"].back()["file"] = "pictures/" + p.at("file").get<std::string>();
      }
    }
  }
}

}  // namespace shoal::console
