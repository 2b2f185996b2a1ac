// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <spdlog/fmt/fmt.h>

#include "operator_console/asking.h"
#include "operator_console/command.h"
#include "operator_console/terminal.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/mapping/library.h"
#include "shoal/mapping/queries.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

struct Keeping {
  Asking asking;
  std::string file;
};

int show(const mapping::Library& library, const std::string& file, bool json) {
  const std::string digest = mapping::digestText(mapping::digestOf(library));
  if (json) {
    Json answer{{"file", file}, {"digest", digest}, {"topics", Json::array()}};
    for (const mapping::LibraryTopic& t : library.topics)
      answer["topics"].push_back({{"name", t.name}, {"weight", t.weight}, {"words", t.words.size()}});
    std::cout << answer.dump(2) << '\n';
    return 0;
  }
  fmt::print("{}: {} names, digest {}\n", file, library.topics.size(), digest);
  for (const mapping::LibraryTopic& t : library.topics)
    fmt::print("  {} {:>10} words seen, {:>6} kinds of word\n", shortened(t.name, 30), t.weight,
               t.words.size());
  return 0;
}

mapping::Library readLibrary(const std::string& file) {
  const std::string text = mapping::readFile(file);
  if (!Json::accept(text)) {
    throw std::runtime_error(file + " is no library: it should be JSON, as `library save` writes it");
  }
  return mapping::parseLibrary(text, file);
}

int save(const Keeping& keeping) {
  const Json answer = answerTo(keeping.asking, {{"query", "library"}});
  const std::string text = answer.at("library");
  const mapping::Library library = mapping::parseLibrary(text, "the answer");
  if (library.topics.empty()) {
    throw std::runtime_error(
        "no label has a name yet, so there is nothing to keep; operator_console name LABEL \"text\"");
  }
  mapping::writeFileAtomically(keeping.file, text);
  return show(library, keeping.file, keeping.asking.json);
}

}  // namespace

void addLibraryCommand(CLI::App& app, Action& chosen) {
  CLI::App* command = app.add_subcommand("library", "names that the next mission begins with");
  command->require_subcommand(1);
  command->footer(
      "  operator_console library save --run runs/a --out reef.library\n"
      "  operator_console library show reef.library");
  CLI::App* saving = command->add_subcommand("save", "writes the named labels and what they look like");
  const auto q = std::make_shared<Keeping>();
  saving->add_option("--out", q->file, "file to write")->required();
  addWhere(*saving, q->asking);
  saving->footer(
      "A library that the mission itself began with stays in it, with what was added.\n\n"
      "  operator_console library save --run runs/a --out reef.library\n"
      "  operator_console launch --world reef:sparse --library reef.library --out runs/b");
  saving->callback([q, &chosen] { chosen = [q] { return save(*q); }; });
  CLI::App* showing = command->add_subcommand("show", "what is in a library file");
  const auto shown = std::make_shared<Keeping>();
  showing->add_option("file", shown->file, "written by library save")->required()->check(CLI::ExistingFile);
  showing->add_flag("--json", shown->asking.json, "answer in JSON");
  showing->footer("  operator_console library show reef.library");
  showing->callback([shown, &chosen] {
    chosen = [shown] { return show(readLibrary(shown->file), shown->file, shown->asking.json); };
  });
}

}  // namespace shoal::console
