// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include <spdlog/fmt/fmt.h>

#include "operator_console/asking.h"
#include "operator_console/command.h"
#include "operator_console/terminal.h"
#include "shoal/number_check.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

struct SurprisesQuestion {
  Asking asking;
  double least = 2;
  size_t most = 20;
  bool csv = false;
};

void printPlaces(const Json& answer, size_t most) {
  const Json& places = answer["places"];
  if (places.empty()) {
    fmt::print("nothing surprised as much as {}\n", answer["least"].get<double>());
    return;
  }
  fmt::print("{:>8} {:>9} {:>9} {:>7} {:>6} {:>9} {:>9}  {:<14} {}\n", "surprise", "x m", "y m", "z m",
             "cells", "seen s", "label", "name", "robots");
  for (size_t i = 0; i < std::min(most, places.size()); ++i) {
    const Json& p = places[i];
    fmt::print("{:>8.2f} {:>9.1f} {:>9.1f} {:>7.1f} {:>6} {:>9.0f} {:>9}  {} {}\n",
               p["surprise"].get<double>(), p["x_m"].get<double>(), p["y_m"].get<double>(),
               p["z_m"].get<double>(), p["cells"].get<int64_t>(), p["first_seen_s"].get<double>(),
               p["label"].get<int>(), shortened(p["name"].get<std::string>(), 14), joined(p["robots"]));
  }
  if (places.size() > most) fmt::print("and {} more: --most\n", places.size() - most);
}

int surprises(const SurprisesQuestion& q) {
  const Json a = answerTo(q.asking, {{"query", "surprises"}, {"least", q.least}, {"csv", q.csv}});
  if (q.asking.json) {
    std::cout << a.dump(2) << '\n';
  } else if (q.csv) {
    std::cout << a["surprise_csv"].get<std::string>();
  } else {
    printPlaces(a, q.most);
  }
  return 0;
}

}  // namespace

void addSurprisesCommand(CLI::App& app, Action& chosen) {
  CLI::App* command =
      app.add_subcommand("surprises", "where robots saw what they had not met, the strangest first");
  const auto q = std::make_shared<SurprisesQuestion>();
  addWhere(*command, q->asking);
  command->add_option("--least", q->least, "leave out cells that surprised less")
      ->check(zeroOrMore)
      ->capture_default_str();
  command->add_option("--most", q->most, "rows of the table")->check(moreThanZero)->capture_default_str();
  command->add_flag("--csv", q->csv, "every cell in CSV")->excludes(command->get_option("--json"));
  command->footer(
      "How badly a robot's labels explained a cell when it came to it, beside all cells that it had seen "
      "before:\n"
      "1 is what one cell in ten exceeds. Robots tell what is 1.5 and more, after 200 cells. Cells that "
      "touch\n"
      "are one place, told by its strangest.\n\n"
      "  operator_console surprises --run runs/a\n"
      "  operator_console surprises --node state --least 3 --json");
  command->callback([q, &chosen] { chosen = [q] { return surprises(*q); }; });
}

}  // namespace shoal::console
