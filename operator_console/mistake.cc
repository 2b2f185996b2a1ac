// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/mistake.h"

#include <algorithm>
#include <vector>

#include "fusion_node/near_word.h"

namespace shoal::console {
namespace {

std::vector<std::string> commandsOf(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    if (!command->get_name().empty()) names.push_back(command->get_name());
  return names;
}

void addOptions(const CLI::App& app, std::vector<std::string>& names) {
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  for (const CLI::App* group : app.get_subcommands([](const CLI::App*) { return true; }))
    if (group->get_name().empty()) addOptions(*group, names);
}

std::string meant(const std::string& word, const std::vector<std::string>& known) {
  const std::string near = fusion_node::nearest(word, known, std::max<size_t>(2, word.size() / 3));
  return near.empty() ? "" : "; did you mean " + near + "?";
}

}  // namespace

std::string mistakeIn(const CLI::App& app) {
  const CLI::App* command = &app;
  std::vector<std::string> options;
  addOptions(app, options);
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    addOptions(*command, options);
  }
  const std::vector<std::string> commands = commandsOf(*command), words = app.remaining(true);
  for (const std::string& word : words)
    if (word.starts_with("-") && word != "--")
      return "unknown option " + word + meant(word.substr(0, word.find('=')), options);
  if (commands.empty() || words.empty()) return "";
  const std::string known = meant(words.front(), commands);
  return "unknown command " + words.front() + (known.empty() ? "; --help lists them" : known);
}

}  // namespace shoal::console
