// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/mistake.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace shoal::console {
namespace {

// Letters to put in, take out or change (Levenshtein).
size_t lettersApart(const std::string& a, const std::string& b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 0; i < a.size(); ++i) {
    size_t above_left = row[0];
    row[0] = i + 1;
    for (size_t j = 0; j < b.size(); ++j) {
      const size_t above = row[j + 1];
      row[j + 1] = std::min({above + 1, row[j] + 1, above_left + (a[i] == b[j] ? 0 : 1)});
      above_left = above;
    }
  }
  return row.back();
}

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
  const std::string near = nearest(word, known);
  return near.empty() ? "" : "; did you mean " + near + "?";
}

}  // namespace

std::string nearest(const std::string& word, std::span<const std::string> known) {
  std::string best;
  size_t least = std::max<size_t>(2, word.size() / 3) + 1;
  for (const std::string& one : known) {
    const size_t apart = lettersApart(word, one);
    if (apart >= least || apart >= word.size()) continue;
    least = apart;
    best = one;
  }
  return best;
}

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
