// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>

#include "operator_console/command.h"
#include "operator_console/match_file.h"

namespace shoal::console {

void addMatchCommand(CLI::App& app, Action& chosen) {
  CLI::App* command =
      app.add_subcommand("match", "match labels given as word counts or as an association graph");
  const auto options = std::make_shared<MatchFileOptions>();
  command->add_option("file", options->path, "JSON file, - for standard input")->required();
  command->add_option("--matcher", options->matcher,
                      "id, hungarian, incremental, components, clear or shoal");
  command->add_option("--similarity", options->similarity,
                      "cosine, overlap, l1, l2, hellinger, js or discounted (default: the matcher's usual)");
  command->add_option("--sigma", options->sigma,
                      "least similarity of a match: auto (the matcher's usual) or a number in (0, 1]");
  command->add_flag("--distinct", options->distinct, "never merge a robot's own labels");
  command->add_flag("--timing", options->timing, "report the seconds that the matching took");
  command->add_flag("--json", options->json, "answer in JSON");
  command->footer(
      "  operator_console match graph.json --matcher clear --json\n"
      "  operator_console match topics.json --distinct --timing");
  command->callback(
      [options, &chosen] { chosen = [options] { return runMatch(*options, std::cout, std::cerr); }; });
}

}  // namespace shoal::console
