// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>
#include <string>

#include <spdlog/fmt/fmt.h>

#include "operator_console/command.h"
#include "operator_console/summary.h"
#include "shoal/mapping/atomic_file.h"

namespace shoal::console {

void addSummaryCommand(CLI::App& app, Action& chosen) {
  struct Flags {
    std::string run, out;
    size_t max_bytes = 0;
  };
  CLI::App* command =
      app.add_subcommand("summary", "a finished mission as one page of HTML, or as a short text");
  const auto flags = std::make_shared<Flags>();
  command->add_option("--run", flags->run, "folder of a finished mission")->required();
  command->add_option("--out", flags->out, "file to write (default: summary.html in the folder)");
  auto* cap = command->add_option("--max-bytes", flags->max_bytes,
                                  "plain text on stdout instead, at most so many bytes: for the link");
  cap->check(CLI::Range(size_t{80}, size_t{1} << 20));
  command->footer(
      "  operator_console summary --run runs/a\n"
      "  operator_console summary --run runs/a --max-bytes 400");
  command->callback([&chosen, flags] {
    chosen = [flags] {
      const MissionSummary mission = readSummaryOf(flags->run);
      const std::string out = flags->out.empty() ? flags->run + "/summary.html" : flags->out;
      if (flags->max_bytes == 0) {
        mapping::writeFileAtomically(out, summaryHtml(mission));
        fmt::print("written to {}\n", out);
        return 0;
      }
      const std::string text = summaryText(mission, flags->max_bytes);
      if (flags->out.empty()) {
        std::cout << text;
      } else {
        mapping::writeFileAtomically(out, text);
      }
      return 0;
    };
  });
}

}  // namespace shoal::console
