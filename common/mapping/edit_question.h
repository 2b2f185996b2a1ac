// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "shoal/mapping/belief_store.h"
#include "shoal/mapping/edit.h"
#include "shoal/mapping/global_map.h"

namespace shoal::mapping {

/// True for questions that change something: those with "edit".
bool isEdit(const nlohmann::ordered_json& question);

/// The edit that a question asks for, {"edit": VERB, ...}:
///   name     label, text          label: a number, a name, or the number of any topic (robot x 10000 +
///   topic) link     a, b                 labels likewise unlink   a, b exclude  robot                "R07"
///   undo     which (optional)     "OPERATOR/3"; without it the author's newest that is in force
///
/// Its time is `now`, or just after the newest edit held, so that it counts after all that its author knew
/// of.
/// @param map  With its correspondences.
/// @throws std::invalid_argument naming what is wrong and what would be right; nlohmann::json::exception for
/// a
///         missing key.
Edit makeEdit(const GlobalMap& map, const BeliefStore& beliefs, const nlohmann::ordered_json& question,
              const std::string& author, world::Timestamp now);

/// What an edit says, for people: `10004 is "sand"`, `10004 and 20003 are the same`, `R07 does not count`.
std::string sentenceOf(const Edit& edit);

}  // namespace shoal::mapping
