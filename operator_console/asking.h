// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json_fwd.hpp>

#include "operator_console/mission_sources.h"

namespace shoal::console {

/// The flags that every question takes.
struct Asking {
  Where where;
  std::string sigma = "auto", similarity;
  bool json = false;
};

/// Adds --node, --run and --log (exactly one), --matcher, --similarity, --sigma and --json.
void addWhere(CLI::App& command, Asking& asking);

/// Where to ask, with the matcher's options read. @throws std::invalid_argument naming a wrong one.
Where whereOf(const Asking& asking);

/// Asks. @throws std::invalid_argument as whereOf(), std::runtime_error with what the answer says went wrong.
nlohmann::ordered_json answerTo(const Asking& asking, const nlohmann::ordered_json& question);

/// The strings of a list, with `separator` between them.
std::string joined(const nlohmann::ordered_json& list, const std::string& separator = " ");

/// Mission time as people write it: seconds ("620", "620.5"), or "10:20" (minutes and seconds), or "1:10:20".
/// @throws std::invalid_argument naming the text and what would be right.
double parseMissionTime(const std::string& text);

}  // namespace shoal::console
