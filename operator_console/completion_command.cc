// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>
#include <string>

#include "operator_console/command.h"
#include "operator_console/completion.h"

namespace shoal::console {

void addCompletionCommand(CLI::App& app, Action& chosen) {
  CLI::App* command = app.add_subcommand("completion", "a script that completes commands and flags with Tab");
  const auto shell = std::make_shared<std::string>();
  command->add_option("shell", *shell, "bash or zsh")->required()->check(CLI::IsMember({"bash", "zsh"}));
  command->footer(
      "  source <(operator_console completion bash)     in ~/.bashrc\n"
      "  source <(operator_console completion zsh)      in ~/.zshrc, after compinit");
  command->callback([&app, shell, &chosen] {
    chosen = [&app, shell] {
      std::cout << (*shell == "bash" ? bashCompletion(app) : zshCompletion(app));
      return 0;
    };
  });
}

}  // namespace shoal::console
