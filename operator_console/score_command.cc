// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <spdlog/fmt/fmt.h>

#include "operator_console/asking.h"
#include "operator_console/command.h"
#include "operator_console/mission_truth.h"
#include "operator_console/named_cells.h"
#include "operator_console/terminal.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/number_check.h"
#include "shoal/rounded.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

struct ScoreFlags {
  Asking asking;
  TruthHint hint;
  std::string named, out;
  int64_t draw = 0;
};

void scoreAgainstTruth(const ScoreFlags& flags, const mapping::MissionView& view) {
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
}

void printNamedScore(const Json& a) {
  fmt::print(
      "AMI about {:.2f}, between {:.2f} and {:.2f} (95 %), if the cells were drawn at random:\n"
      "{} of {} cells have a name, {} labels, {} names",
      a["ami"].get<double>(), a["low"].get<double>(), a["high"].get<double>(), a["named"].get<int64_t>(),
      a["cells"].get<int64_t>(), a["labels"].get<int64_t>(), a["names"].get<int64_t>());
  if (a["unnamed"] > 0) fmt::print("; {} without a name", a["unnamed"].get<int64_t>());
  if (a["off_map"] > 0) fmt::print("; {} named, but not on the map", a["off_map"].get<int64_t>());
  fmt::print("\n{:>9}  {:<20} {:>6} {:>6}  {}\n", "label", "called", "named", "alike", "most often named");
  for (const Json& row : a["by_label"]) {
    fmt::print("{:>9}  {} {:>6} {:>5.0f}%  {}\n", row["label"].get<int>(),
               shortened(row["name"].get<std::string>(), 20), row["named"].get<int64_t>(),
               100 * row["share"].get<double>(), shortened(row["most_often"].get<std::string>(), 30));
  }
}

int score(const ScoreFlags& flags) {
  const mapping::MissionView view = viewOf(whereOf(flags.asking));
  if (flags.draw > 0) {
    const std::string csv = cellsToName(view, flags.draw, flags.hint.seed);
    if (flags.out.empty()) {
      std::cout << csv;
    } else {
      if (std::filesystem::exists(flags.out)) {
        throw std::invalid_argument(flags.out + " is there already; names in it would be lost");
      }
      mapping::writeFileAtomically(flags.out, csv);
      fmt::print("{}: write into the last column what each cell is, then: score --named {}\n", flags.out,
                 flags.out);
    }
  } else if (!flags.named.empty()) {
    const world::Grid grid(view.cell_size_m);
    const Json a = namedScore(view, parseNamedCells(mapping::readFile(flags.named), grid, flags.named));
    if (flags.asking.json) {
      std::cout << a.dump(2) << '\n';
    } else {
      printNamedScore(a);
    }
  } else {
    scoreAgainstTruth(flags, view);
  }
  return 0;
}

}  // namespace

void addScoreCommand(CLI::App& app, Action& chosen) {
  CLI::App* command = app.add_subcommand(
      "score",
      "score the map as it is held now, edits and all: against its world, or by cells that you name");
  const auto flags = std::make_shared<ScoreFlags>();
  addWhere(*command, flags->asking);
  auto* how = command->add_option_group("how", "One of");
  how->add_option("--world", flags->hint.world, "the world it is flown over, whose labels are the truth");
  auto* draw = how->add_option("--draw", flags->draw,
                               "draw so many cells of the map at random, for you to name, as CSV")
                   ->check(CLI::Range(int64_t{1}, int64_t{1'000'000}));
  how->add_option("--named", flags->named,
                  "that file with names: estimate the AMI of the whole map from them");
  how->require_option(1);
  command->add_option("--out", flags->out, "with --draw: the file to write; not one that is there already")
      ->needs(draw);
  command
      ->add_option("--seed", flags->hint.seed,
                   "of the mission, for --node and --log; with --draw, of the draw")
      ->capture_default_str();
  command
      ->add_option("--robots", flags->hint.robots,
                   "for --node and --log, when not all of the team were heard")
      ->check(zeroOrMore);
  command->add_option("--observations", flags->hint.observations, "for --node and --log: images per robot")
      ->check(zeroOrMore);
  command->footer(
      "evaluate matches a run anew with every matcher, without edits; score takes the labels as they are.\n"
      "Where nobody knows the truth, name some cells: 100 tell the AMI to about .15 either way, 200 to .1,\n"
      "400 to .06; fewer than 20 tell nothing. Cells that you chose yourself tell less than they seem to.\n\n"
      "  operator_console score --world reef:sparse --node state\n"
      "  operator_console score --run runs/a --draw 100 --out cells.csv\n"
      "  operator_console score --run runs/a --named cells.csv");
  command->callback([flags, &chosen] { chosen = [flags] { return score(*flags); }; });
}

}  // namespace shoal::console
