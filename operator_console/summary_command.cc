// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include <spdlog/fmt/fmt.h>

#include "operator_console/command.h"
#include "operator_console/summary_page.h"
#include "shoal/mapping/atomic_file.h"

namespace shoal::console {

void addSummaryCommand(CLI::App& app, Action& chosen) {
  struct Flags {
    std::string run, out;
  };
  CLI::App* command =
      app.add_subcommand("summary", "a finished mission as one HTML page that needs nothing else");
  const auto flags = std::make_shared<Flags>();
  command->add_option("--run", flags->run, "folder of the mission")->required();
  command->add_option("--out", flags->out, "file to write (default: summary.html in the folder)");
  command->footer(
      "launch writes it at the end; ask again after you have named or linked something.\n\n"
      "  operator_console summary --run runs/a --out a.html");
  command->callback([flags, &chosen] {
    chosen = [flags] {
      const std::string out = flags->out.empty() ? flags->run + "/summary.html" : flags->out;
      mapping::writeFileAtomically(out, summaryPage(flags->run));
      fmt::print("{}\n", out);
      return 0;
    };
  });
}

}  // namespace shoal::console
