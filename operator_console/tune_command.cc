// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>

#include <spdlog/fmt/fmt.h>

#include "operator_console/command.h"
#include "operator_console/tune.h"

namespace shoal::console {

void addTuneCommand(CLI::App& app, Action& chosen) {
  CLI::App* command = app.add_subcommand("tune", "search hyper-parameters by AMI on a world kept for that");
  struct Flags {
    TuneOptions options;
    bool json = false;
  };
  const auto flags = std::make_shared<Flags>();
  TuneOptions& o = flags->options;
  command->add_option("--world", o.world, "where to score")->capture_default_str();
  command->add_option("--out", o.out, "folder for trials.json and best.json");
  command->add_option("--profile", o.profile, "words, and the hyper-parameters that are not searched")
      ->capture_default_str();
  command
      ->add_option("--knobs", o.knobs,
                   "what is searched: alpha, beta, gamma, neighbor_weight for paper (default alpha,beta); "
                   "evidence, beta, coupling for best (default evidence,beta)")
      ->delimiter(',');
  command->add_option("--score", o.score, "alone (one robot's map) or team (the fused map by CLEAR)")
      ->capture_default_str();
  command->add_option("--robots", o.num_robots, "shares of the world")->capture_default_str();
  command->add_option("--observations", o.observations, "images per share")->capture_default_str();
  command->add_option("--seeds", o.seeds, "a setting's score is the mean over so many")
      ->capture_default_str();
  command->add_option("--random", o.random, "settings spread over the space before guided ones")
      ->capture_default_str();
  command->add_option("--trials", o.trials, "settings in all")->capture_default_str();
  command->add_option("--seed", o.seed, "decides all randomness")->capture_default_str();
  command->add_flag("--json", flags->json, "answer in JSON");
  command->footer(
      "Stopped and started again with the same --out, it goes on where it was.\n\n"
      "  operator_console tune --world reef:tuning --profile best --knobs evidence,beta --out runs/tune");
  command->callback([flags, &chosen] {
    chosen = [flags] {
      const nlohmann::ordered_json result = tune(flags->options);
      if (flags->json) {
        std::cout << result.dump(2) << '\n';
      } else {
        for (const auto& [name, value] : result.at("best").items())
          std::cout << fmt::format("{:<18} {:g}\n", name, value.get<double>());
        std::cout << fmt::format("{:<18} {:.4f}, best of {} settings\n", "AMI",
                                 result.at("ami").get<double>(), result.at("trials").get<size_t>());
      }
      return 0;
    };
  });
}

}  // namespace shoal::console
