// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shoal/eval/team_words.h"
#include "shoal/mapping/global_map.h"
#include "shoal/mapping/local_belief.h"
#include "shoal/robot/profile.h"

namespace shoal::wire {

/// Twelve robots over a world with profile `best`, in this process: what they believe in the end is what a
/// launched mission with seed 1 comes to.
inline constexpr int kFlyingRobots = 12;
using Team = std::vector<mapping::LocalBelief>;
using Knobs = topics::CellLabelHyperparameters;

/// What they see; cell_size_m 0 = the world's own.
eval::TeamWords look(const std::string& world, int32_t images, double cell_size_m = 0);

/// The knobs of profile `best`.
Knobs usualKnobs();
Team learn(const eval::TeamWords& words, uint64_t seed, const Knobs& knobs);

/// The map of a node that has heard all of it, by `shoal`.
mapping::GlobalMap fused(const Team& team);

}  // namespace shoal::wire
