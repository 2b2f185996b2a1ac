// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "shoal/mapping/belief_store.h"
#include "shoal/mapping/edit.h"

namespace shoal::mapping {

/// An edit for people and programs: as in edits.json, with "time_s", "author", "says" and "standing".
nlohmann::ordered_json editAnswer(const Edit& edit, const BeliefStore& beliefs);

/// Every edit held, the earliest first: {"edits": [...], "excluded": ["R07"]}.
nlohmann::ordered_json editsAnswer(const BeliefStore& beliefs);

}  // namespace shoal::mapping
