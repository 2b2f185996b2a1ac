// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "shoal/mapping/belief_store.h"
#include "shoal/matching/matcher.h"
#include "shoal/topics/team_topics.h"
#include "shoal/world/ids.h"

namespace shoal::robot {

/// What a team knows, for one of its robots to look again at its map: the topics of all comparable robots,
/// matched under what operators decided. A function of the topics, settings and edits held, and of nothing
/// that is said of cells: who held all of a team's topics before it looked again makes the same of it as who
/// does after. Whatever others say, a learner of the same words can look again with it. Without topics of
/// `self` (it is excluded, or learns with other words) there is nothing.
/// @param heard  Of everybody, `self` included.
/// @throws std::invalid_argument as matching::match() for wrong options.
topics::TeamTopics teamTopics(const mapping::BeliefStore& heard, world::RobotId self,
                              const matching::MatcherOptions& matcher);

}  // namespace shoal::robot
