// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <spdlog/fmt/fmt.h>

#include "operator_console/asking.h"
#include "operator_console/command.h"
#include "operator_console/evaluate.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/rounded.h"
#include "shoal/world/place.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

struct ScoreFlags {
  Asking asking;
  std::string world;
  uint64_t seed = 1;
  int robots = 0;
  int32_t observations = 0;
};

// How the team flies, as far as it is known: what a run's summary says, else what its robots say. It matters
// where the truth is projected from the frames that the team sees.
world::SurveyOptions teamAsFlown(const ScoreFlags& flags, const mapping::MissionView& view,
                                 const world::Place& place) {
  if (!flags.asking.where.run.empty()) {
    return teamOf(Json::parse(mapping::readFile(flags.asking.where.run + "/summary.json")));
  }
  world::SurveyOptions team;
  team.num_robots = flags.robots;
  team.observations = flags.observations;
  for (const mapping::NodeStatus& node : view.nodes) {
    if (node.phase == "node" || !world::parseRobotId(node.name)) continue;
    if (flags.robots == 0) ++team.num_robots;
    if (flags.observations == 0) team.observations = std::max(team.observations, node.num_observations);
  }
  team.num_robots = std::max(team.num_robots, 1);
  team.cell_size_m = view.cell_size_m;
  return place.completed(team);
}

int score(const ScoreFlags& flags) {
  const mapping::MissionView view = viewOf(whereOf(flags.asking));
  uint64_t seed = flags.seed;
  std::optional<world::Camera> camera;
  if (!flags.asking.where.run.empty()) {
    const Json summary = Json::parse(mapping::readFile(flags.asking.where.run + "/summary.json"));
    seed = summary.at("seed");
    camera = cameraOf(summary);
  }
  const auto place = world::openPlace(flags.world, seed, camera);
  if (place->classes().empty())
    throw std::runtime_error(flags.world + " has no labels: there is nothing to score against");
  const world::SurveyOptions team = teamAsFlown(flags, view, *place);
  const eval::TruthOfCell truth = eval::truthFor(*place, team, world::Grid(view.cell_size_m));
  std::vector<std::pair<world::CellIndex, int>> labels;
  for (const mapping::GlobalCell& c : view.map.cells) labels.emplace_back(c.cell, number(c.label));
  const eval::Score s = eval::score(labels, truth);
  if (flags.asking.json) {
    std::cout << Json{{"cells", s.cells},     {"scored", s.scored},         {"labels", s.labels},
                      {"classes", s.classes}, {"ami", rounded(s.ami, 1e6)}, {"nmi", rounded(s.nmi, 1e6)}}
                     .dump(2)
              << '\n';
  } else {
    fmt::print("AMI {:.3f}, NMI {:.3f}: {} labels, {} classes, {} of {} cells have a truth\n", s.ami, s.nmi,
               s.labels, s.classes, s.scored, s.cells);
  }
  return 0;
}

}  // namespace

void addScoreCommand(CLI::App& app, Action& chosen) {
  CLI::App* command =
      app.add_subcommand("score", "score the map as it is held now, edits and all, against its world");
  const auto flags = std::make_shared<ScoreFlags>();
  addWhere(*command, flags->asking);
  command->add_option("--world", flags->world, "the world it is flown over")->required();
  command->add_option("--seed", flags->seed, "of the mission, for --node and --log")->capture_default_str();
  command->add_option("--robots", flags->robots, "for --node and --log, when not all of the team were heard")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--observations", flags->observations, "for --node and --log: images per robot")
      ->check(CLI::NonNegativeNumber);
  command->footer(
      "evaluate matches a run anew with every matcher, without edits; score takes the labels as they are.\n\n"
      "  operator_console score --world reef:sparse --node state");
  command->callback([flags, &chosen] { chosen = [flags] { return score(*flags); }; });
}

}  // namespace shoal::console
