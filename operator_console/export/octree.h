// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "shoal/mapping/queries.h"

namespace shoal::console {

/// The map as an OctoMap ColorOcTree (.ot): every cell occupied, in its label's colour.
///
/// OctoMap's voxels lie between multiples of their edge, our cells around them. So that nothing is moved,
/// voxels have half a cell's edge, and a cell is eight of them.
/// @throws std::runtime_error for a cell further than 16383 cells from (0, 0, 0): an OctoMap ends there.
/// Cost: about 0.5 kB of memory a cell.
std::string colorOcTree(const mapping::MissionView& view);

}  // namespace shoal::console
