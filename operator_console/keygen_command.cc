// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <string>

#include <spdlog/fmt/fmt.h>

#include "operator_console/command.h"
#include "shoal/comms/seal.h"

namespace shoal::console {

void addKeygenCommand(CLI::App& app, Action& chosen) {
  CLI::App* command = app.add_subcommand("keygen", "make a key for a team: only who has it is listened to");
  const auto file = std::make_shared<std::string>();
  command->add_option("file", *file, "a new file, which only you will be able to read")->required();
  command->footer(
      "Copy the file to every machine of the team (scp -p), and give --key FILE to robot_agent, fusion_node "
      "and\n"
      "launch. docs/security.md says what it protects and what it does not.\n\n"
      "  operator_console keygen team.key");
  command->callback([&chosen, file] {
    chosen = [file] {
      const comms::SealKey key = comms::SealKey::make(*file);
      fmt::print("key {} is in {}\n", key.id(), *file);
      return 0;
    };
  });
}

}  // namespace shoal::console
