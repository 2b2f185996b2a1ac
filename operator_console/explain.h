// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "shoal/eval/explanation.h"
#include "shoal/world/world.h"

namespace shoal::console {

/// What people read after the score table: the ceiling of any matcher, the robots' own topics, what each
/// label holds, and which classes were taken for which. 80 columns.
std::string explanationText(const eval::Explanation& explanation,
                            const std::vector<world::TruthClass>& classes);

/// The same for `evaluate --explain --json`.
nlohmann::ordered_json explanationJson(const eval::Explanation& explanation,
                                       const std::vector<world::TruthClass>& classes);

}  // namespace shoal::console
