// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/mission_keys.h"

#include <algorithm>
#include <filesystem>

#include "fusion_node/near_word.h"

namespace shoal::fusion_node {
namespace {

// Shorter words of ours are as near to each other as a typing error is: rate, state.
constexpr size_t kLeastLetters = 6;
constexpr size_t kMostWrong = 2;

// Those of groups of options too, which CLI11 has as commands without a name.
void addFlags(const CLI::App& app, bool of_all_commands, std::vector<std::string>& flags) {
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) flags.push_back(name);
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    if (of_all_commands || command->get_name().empty()) addFlags(*command, of_all_commands, flags);
}

}  // namespace

std::vector<std::string> likelyTypos(const CLI::App& app) {
  const CLI::Option* config = app.get_config_ptr();
  if (config == nullptr || config->count() == 0) return {};
  const auto file = config->as<std::string>();
  if (!std::filesystem::is_regular_file(file)) return {};  // a pipe can be read once only
  std::vector<std::string> flags, known, typos;
  addFlags(app, true, known);
  addFlags(app, false, flags);
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    addFlags(*command, false, flags);
  }
  for (const CLI::ConfigItem& item : app.get_config_formatter()->from_file(file)) {
    if (item.name == "++" || item.name == "--") continue;  // where a section begins and ends
    if (!item.parents.empty() && item.parents.back() != command->get_name()) continue;
    if (item.name.size() < kLeastLetters || std::ranges::find(known, item.name) != known.end()) continue;
    if (const std::string near = nearest(item.name, flags, kMostWrong); !near.empty())
      typos.push_back(file + ": nothing is known of \"" + item.name + "\"; did you mean \"" + near + "\"?");
  }
  return typos;
}

}  // namespace shoal::fusion_node
