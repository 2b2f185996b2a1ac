// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "shoal/mapping/belief_store.h"
#include "shoal/mapping/queries.h"

namespace shoal::mapping {

/// The answer to `node R03`: how it is doing (as in statusAnswer()), for how long it has been silent, what it
/// has told of its topics and cells and how much of that the map shows.
///
/// "silent_s" counts to the latest heartbeat of anybody; "told_until_s" is the latest time at which it saw a
/// cell that is held, null without any; "behind_s" is how much older that is than its heartbeat.
/// @returns {"error": ...} when nothing was ever heard of that node.
nlohmann::ordered_json nodeAnswer(const MissionView& view, const BeliefStore& beliefs,
                                  const std::string& node);

}  // namespace shoal::mapping
