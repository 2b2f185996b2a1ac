// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>
#include <string>

#include "operator_console/command.h"

namespace shoal::console {

void addUnbuiltCommands(CLI::App& app, Action& chosen) {
  for (const std::string name : {"serve"}) {
    CLI::App* command =
        app.add_subcommand(name, "not built yet")->group("")->prefix_command()->fallthrough(false);
    command->set_help_flag();
    command->callback([&chosen, name] {
      chosen = [name]() -> int { throw std::invalid_argument(name + " is not built yet"); };
    });
  }
}

}  // namespace shoal::console
