// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "fusion_node/process.h"
#include "operator_console/command.h"
#include "operator_console/replay.h"

namespace shoal::console {
namespace {

struct ReplayFlags {
  std::string log, out, key, sigma = "auto", similarity;
  matching::MatcherOptions matcher = matching::usualMatcher();
  bool json = false;
};

int run(ReplayFlags flags) {
  flags.matcher.sigma = matching::parseSigma(flags.sigma);
  flags.matcher.similarity =
      flags.similarity.empty() ? matching::usualSimilarity(flags.matcher.matcher) : flags.similarity;
  const Replay result = replay(flags.log, flags.out, flags.matcher, flags.key);
  std::cout << (flags.json ? result.json().dump(2) + "\n" : result.text());
  return result.isWhole() ? 0 : 1;
}

}  // namespace

void addReplayCommand(CLI::App& app, Action& chosen) {
  CLI::App* command = app.add_subcommand("replay", "rebuild a mission's map from its recording alone");
  const auto flags = std::make_shared<ReplayFlags>();
  command->add_option("log", flags->log, "a recording made by lcm-logger")->required();
  command->add_option("--out", flags->out, "folder for the map's files")->required();
  command
      ->add_option("--matcher", flags->matcher.matcher,
                   "as the mission's: id, hungarian, incremental, components, clear or shoal")
      ->capture_default_str();
  command->add_option("--similarity", flags->similarity,
                      "cosine, overlap, l1, l2, hellinger, js or discounted (default: the matcher's usual)");
  command
      ->add_option("--sigma", flags->sigma,
                   "least similarity of a match: auto (the matcher's usual) or a number in (0, 1]")
      ->capture_default_str();
  command->add_option("--key", flags->key, "the team's key file, to check the seals");
  command->add_flag("--json", flags->json, "answer in JSON");
  command->footer(
      "Exits with 1, naming what the recording lacks, when the map cannot be made whole from it.\n\n"
      "  operator_console replay runs/a/mission.lcmlog --out rebuilt");
  command->callback([&chosen, flags] { chosen = [flags] { return run(*flags); }; });
}

}  // namespace shoal::console
