// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "shoal/mapping/belief_store.h"
#include "shoal/mapping/queries.h"
#include "shoal/matching/matcher.h"

namespace shoal::mapping {

/// The answer to `why LABEL`: which topics were joined under a label and what spoke for and against it.
///
/// Every member tells its most similar fellow members (up to 3), the most similar topic outside the label,
/// and its mean similarity to its fellows. A robot's own topics count as outsiders only where the matcher may
/// join them. Words are those that the members have in common, by word group: `share` is the mean over the
/// members of the word's share of the group.
///
/// "margin" is how far sigma is from the similarity that would decide otherwise, and null where nothing is
/// compared with sigma. With "clear" edges decide: of all pairs of a member and any topic it could be joined
/// with, the one nearest to sigma; while sigma moves by less than that, the label's edges stay the same. With
/// "shoal" means between groups decide: sigma less the mean similarity to the nearest other label.
///
/// @param view     whose map was fused from `beliefs` with `options`.
/// @returns {"error": ...} when the map has no such label.
/// Cost: members x topics similarities; with "discounted" those of all pairs.
nlohmann::ordered_json whyAnswer(const MissionView& view, const BeliefStore& beliefs,
                                 const matching::MatcherOptions& options, const std::string& label);

}  // namespace shoal::mapping
