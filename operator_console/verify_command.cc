// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "fusion_node/mission_file.h"
#include "operator_console/command.h"
#include "operator_console/verify.h"

namespace shoal::console {

void addVerifyCommand(CLI::App& app, Action& chosen) {
  struct Flags {
    std::string log, key;
    bool json = false;
  };
  CLI::App* command =
      app.add_subcommand("verify", "prove from a recording: budget kept, gaps repaired, all nodes agree");
  const auto flags = std::make_shared<Flags>();
  command->add_option("log", flags->log, "a recording made by lcm-logger")->required();
  command->add_option("--key", flags->key, "the team's key file, to check the seals");
  command->add_flag("--json", flags->json, "answer in JSON");
  command->footer(
      "Exits with 1 when something was not in order.\n\n"
      "  operator_console verify runs/a/mission.lcmlog");
  command->callback([&chosen, flags] {
    chosen = [flags] {
      if (fusion_node::isSqlite(flags->log)) {
        throw std::invalid_argument(flags->log +
                                    " is what a node remembers: not all that was sent, so it proves nothing; "
                                    "give a recording (--record)");
      }
      const Verification result = verify(flags->log, flags->key);
      std::cout << (flags->json ? result.json().dump(2) + "\n" : result.text());
      return result.wrong().empty() ? 0 : 1;
    };
  });
}

}  // namespace shoal::console
