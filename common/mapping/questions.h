// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include <nlohmann/json_fwd.hpp>

#include "shoal/mapping/belief_store.h"
#include "shoal/mapping/events_answer.h"
#include "shoal/mapping/queries.h"
#include "shoal/matching/matcher.h"

namespace shoal::mapping {

/// Whom a question is put to: a running node, a finished run or a recording. All know the same things.
struct Witness {
  const MissionView& view;
  /// The state that the map was fused from. Called when a question needs it, for it may have to be read.
  std::function<const BeliefStore&()> beliefs;
  matching::MatcherOptions matcher;  ///< with which the map was fused
  /// What it saw happen. None when empty: it keeps no history.
  std::function<std::vector<MissionEvent>()> events = {};
};

/// Answers one question, {"query": NAME, ...}:
///   status | labels | map | pictures | library
///   at    x, y            numbers, metres
///   area  label, and optionally min_m2, since_s, certainty
///   why   label           number as text, or name
///   node  node            "R03"
///   surprises             and optionally least, csv (true: also all cells as "surprise_csv")
///   edits | events
/// Questions that change something are for makeEdit().
/// A question is a peer's text: one that is unknown, incomplete or wrong is answered with {"error": ...}.
nlohmann::ordered_json answer(const Witness& witness, const nlohmann::ordered_json& question);

/// With a library in force, each row of "labels" says what its label is called there, as "library": an empty
/// list when it is new. @param map  With its correspondences.
void addLibraryNames(nlohmann::ordered_json& rows, const GlobalMap& map, const BeliefStore& beliefs);

}  // namespace shoal::mapping
