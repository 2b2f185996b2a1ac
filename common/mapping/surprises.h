// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "shoal/mapping/belief_store.h"
#include "shoal/mapping/global_map.h"
#include "shoal/mapping/queries.h"
#include "shoal/world/grid.h"

namespace shoal::mapping {

/// A cell of the fused map that surprised the robot whose cell it is.
struct SurprisingCell {
  GlobalCell cell;
  float surprise = 0;  ///< how unusual it was to the robot when it saw it: 1 is what one cell in ten exceeds
  bool operator==(const SurprisingCell&) const = default;
};

/// Those of a map's cells whose robots told of a surprise (surpriseSteps()), ascending by cell.
/// @param beliefs  what the map was fused from.
/// Cost: O(cells that robots told certainties of).
std::vector<SurprisingCell> surprisesOf(const GlobalMap& map, const BeliefStore& beliefs);

/// As CSV: x_m,y_m,z_m,label,robot,seen_s,surprise; three decimals.
std::string surprisesCsv(const std::vector<SurprisingCell>& cells, const world::Grid& grid);

/// Where the surprises are: {"cells", "least", "places": [{"x_m", "y_m", "z_m", "surprise", "label", "name",
/// "cells", "area_m2", "robots", "first_seen_s", "last_seen_s"}]}. Columns that touch are one place, told by
/// its most surprising cell; the most surprising place first, then the larger one.
/// @param least  leave out cells below. @throws std::invalid_argument unless it is finite and >= 0.
nlohmann::ordered_json surprisesAnswer(const MissionView& view, const BeliefStore& beliefs, double least);

}  // namespace shoal::mapping
