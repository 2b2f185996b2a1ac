// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <memory>

#include "operator_console/command.h"
#include "operator_console/reproduce.h"
#include "operator_console/reproduce_report.h"

namespace shoal::console {

void addReproduceCommand(CLI::App& app, Action& chosen) {
  CLI::App* command = app.add_subcommand(
      "reproduce", "the paper's experiments in one go: its Table I and figures on reefs or any worlds");
  struct Flags {
    ReproduceOptions options;
    bool json = false;
  };
  const auto flags = std::make_shared<Flags>();
  ReproduceOptions& o = flags->options;
  command->add_option("--world", o.worlds, "worlds, one or more")->capture_default_str();
  command->add_option("--out", o.out,
                      "folder for report.html, the tables as CSV, and what is kept to go on from");
  command->add_option("--robots", o.num_robots, "robots of the team")->capture_default_str();
  command->add_option("--observations", o.observations, "images per robot")->capture_default_str();
  command->add_option("--repeats", o.repeats, "missions with other random numbers over the same images")
      ->capture_default_str();
  command->add_option("--profile", o.profile, "words and hyper-parameters: best or paper")
      ->capture_default_str();
  command
      ->add_option("--shares", o.shares,
                   "teams among which the same area and number of images are shared out")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--share-repeats", o.share_repeats, "repeats of each of these, 0 = leave out")
      ->capture_default_str();
  auto* exchange = command->add_option("--exchange-every", o.exchange_every,
                                       "images between two exchanges of the team that merges its models, 0 = "
                                       "leave out (default: 25 for paper, 0 for best)");
  command->add_option("--seed", o.seed, "of the places and the first repeat")->capture_default_str();
  command->add_option("--cell-size-m", o.cell_size_m, "edge of a cell, m (default: the world's)");
  command->add_option("--altitude-m", o.altitude_m, "camera height, m (default: native resolution)");
  command->add_flag("--json", flags->json, "print the summary as JSON");
  command->footer(
      "Stopped and started again with the same --out, it goes on where it was.\n\n"
      "  operator_console reproduce --out runs/paper\n"
      "  operator_console reproduce --world bay --profile best --observations 60 --repeats 3 --out runs/bay");
  command->callback([flags, exchange, &chosen] {
    chosen = [flags, exchange] {
      ReproduceOptions& asked = flags->options;
      if (exchange->count() == 0 && !canMergeModels(asked.profile)) asked.exchange_every = 0;
      const Reproduction reproduction = reproduce(flags->options);
      std::fputs(
          flags->json ? (summaryOf(reproduction).dump(2) + "\n").c_str() : tableOf(reproduction).c_str(),
          stdout);
      return 0;
    };
  });
}

}  // namespace shoal::console
