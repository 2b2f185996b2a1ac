// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "shoal/mapping/global_map.h"
#include "shoal/world/grid.h"

namespace shoal::console {

/// The map as a binary little-endian PLY point cloud, a point a cell at its centre, metres of the mission
/// frame: double x y z, uchar red green blue (the label's colour, as in pictures), double scalar_label, float
/// scalar_certainty, scalar_robot, and scalar_age: seconds of mission time before the newest cell was seen.
std::string globalMapPly(const mapping::GlobalMap& map, const world::Grid& grid);

}  // namespace shoal::console
