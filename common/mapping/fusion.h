// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "shoal/mapping/belief_store.h"
#include "shoal/mapping/global_map.h"
#include "shoal/matching/matcher.h"

namespace shoal::mapping {

/// Fuses everything heard into one consistent map (Jamieson et al. 2021, §III-IV): match the topics of all
/// robots, translate every robot's labels, and let each cell show the robot that saw it last (`seen`, then
/// the higher robot number; g(b) = Π(g_n*(b)), §III).
///
/// Pure: equal state and options, equal map, byte for byte, on every node.
/// What operators decided counts: names, links, robots that are left out (judgement.h). A robot that is
/// excluded leaves the very map of a state that never held it. A cell whose topic has not been heard carries
/// the label robot x 10000 + topic.
///
/// @throws std::invalid_argument as matching::match() does for wrong options.
/// Cost: O(cells) plus the matching. For a state that grows: FusedMap (fused_map.h).
GlobalMap fuse(const BeliefStore& beliefs, const matching::MatcherOptions& options);

}  // namespace shoal::mapping
