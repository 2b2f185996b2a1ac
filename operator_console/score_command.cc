// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <spdlog/fmt/fmt.h>

#include "operator_console/asking.h"
#include "operator_console/command.h"
#include "operator_console/mission_truth.h"
#include "shoal/rounded.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

struct ScoreFlags {
  Asking asking;
  TruthHint hint;
};

int score(const ScoreFlags& flags) {
  const mapping::MissionView view = viewOf(whereOf(flags.asking));
  const MissionTruth truth = truthOf(whereOf(flags.asking), view, flags.hint);
  std::vector<std::pair<world::CellIndex, int>> labels;
  for (const mapping::GlobalCell& c : view.map.cells) labels.emplace_back(c.cell, number(c.label));
  const eval::Score s = eval::score(labels, truth.of_cell);
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
  command->add_option("--world", flags->hint.world, "the world it is flown over")->required();
  command->add_option("--seed", flags->hint.seed, "of the mission, for --node and --log")
      ->capture_default_str();
  command
      ->add_option("--robots", flags->hint.robots,
                   "for --node and --log, when not all of the team were heard")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--observations", flags->hint.observations, "for --node and --log: images per robot")
      ->check(CLI::NonNegativeNumber);
  command->footer(
      "evaluate matches a run anew with every matcher, without edits; score takes the labels as they are.\n\n"
      "  operator_console score --world reef:sparse --node state");
  command->callback([flags, &chosen] { chosen = [flags] { return score(*flags); }; });
}

}  // namespace shoal::console
