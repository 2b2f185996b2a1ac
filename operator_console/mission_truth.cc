// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/mission_truth.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "operator_console/evaluate.h"
#include "shoal/mapping/atomic_file.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

Json summaryOf(const std::string& run) { return Json::parse(mapping::readFile(run + "/summary.json")); }

// How the team flies, as far as it is known: what a run's summary says, else what its robots say. It matters
// where the truth is projected from the frames that the team sees.
world::SurveyOptions teamAsFlown(const Where& where, const TruthHint& hint, const mapping::MissionView& view,
                                 const world::Place& place) {
  if (!where.run.empty()) return teamOf(summaryOf(where.run));
  world::SurveyOptions team;
  team.num_robots = hint.robots;
  team.observations = hint.observations;
  for (const mapping::NodeStatus& node : view.nodes) {
    if (node.phase == "node" || !world::parseRobotId(node.name)) continue;
    if (hint.robots == 0) ++team.num_robots;
    if (hint.observations == 0) team.observations = std::max(team.observations, node.num_observations);
  }
  team.num_robots = std::max(team.num_robots, 1);
  team.cell_size_m = view.cell_size_m;
  return place.completed(team);
}

}  // namespace

std::string worldOf(const Where& where, const TruthHint& hint) {
  if (!hint.world.empty() || where.run.empty()) return hint.world;
  try {
    return summaryOf(where.run).value("world", "");
  } catch (const Json::exception&) {
    return "";
  }
}

MissionTruth truthOf(const Where& where, const mapping::MissionView& view, const TruthHint& hint) {
  uint64_t seed = hint.seed;
  std::optional<world::Camera> camera;
  if (!where.run.empty()) {
    const Json summary = summaryOf(where.run);
    seed = summary.at("seed");
    camera = cameraOf(summary);
  }
  const std::string world = worldOf(where, hint);
  if (!where.run.empty()) warnOfOtherWorld(where.run, summaryOf(where.run), world);
  const std::shared_ptr<const world::Place> place = world::openPlace(world, seed, camera);
  if (place->classes().empty()) throw std::runtime_error(world + " has no labels: its truth is not known");
  return {place,
          eval::truthFor(*place, teamAsFlown(where, hint, view, *place), world::Grid(view.cell_size_m))};
}

}  // namespace shoal::console
