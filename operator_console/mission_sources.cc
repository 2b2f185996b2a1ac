// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/mission_sources.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "fusion_node/query_server.h"
#include "operator_console/recorded_mission.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/mapping/map_files.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

uint64_t digestFrom(const Json& text) { return std::stoull(text.get<std::string>(), nullptr, 16); }

// A node hands its map over as the same CSV text that a run's folder holds.
mapping::MissionView viewOfNode(const std::string& state_dir) {
  const Json status = fusion_node::askNode(state_dir, {{"query", "status"}});
  const Json map = fusion_node::askNode(state_dir, {{"query", "map"}});
  mapping::MissionView view;
  view.mission = status.at("mission_id");
  view.cell_size_m = map.at("cell_size_m");
  view.state_digest = digestFrom(status.at("digest").at("state"));
  view.map_digest = digestFrom(status.at("digest").at("map"));
  for (const Json& node : status.at("nodes")) view.nodes.push_back(mapping::nodeFromJson(node));
  view.map = mapping::parseGlobalMap(map.at("global_map_csv"), map.at("labels_csv"),
                                     world::Grid(view.cell_size_m), state_dir);
  return view;
}

}  // namespace

mapping::MissionView viewOfRun(const std::string& dir) {
  const std::string path = dir + "/summary.json";
  if (!std::filesystem::exists(path)) {
    throw std::runtime_error(dir + " is not a finished run: it has no summary.json");
  }
  mapping::MissionView view;
  try {
    const Json summary = Json::parse(mapping::readFile(path));
    view.mission = summary.at("mission_id");
    view.cell_size_m = summary.at("cell_size_m");
    view.state_digest = digestFrom(summary.at("digest").at("state"));
    view.map_digest = digestFrom(summary.at("digest").at("map"));
    for (const Json& node : summary.at("nodes")) view.nodes.push_back(mapping::nodeFromJson(node));
  } catch (const Json::exception& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
  view.map = mapping::readGlobalMap(dir, world::Grid(view.cell_size_m));
  return view;
}

mapping::MissionView viewOf(const Where& where) {
  if (!where.node.empty()) return viewOfNode(where.node);
  if (!where.run.empty()) return viewOfRun(where.run);
  return readRecording(where.log, where.matcher).state.view();
}

Json ask(const Where& where, const Json& question) {
  if (!where.node.empty()) return fusion_node::askNode(where.node, question);
  const mapping::MissionView view = viewOf(where);
  const std::string query = question.at("query");
  if (query == "status") return mapping::statusAnswer(view);
  if (query == "labels") return mapping::labelsAnswer(view);
  return mapping::atAnswer(view, question.at("x"), question.at("y"));
}

}  // namespace shoal::console
