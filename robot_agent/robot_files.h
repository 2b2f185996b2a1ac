// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "shoal/mapping/local_belief.h"
#include "shoal/mapping/poses_file.h"

namespace shoal::robot_agent {

/// Writes what a robot believes and where it was, as mapping/belief_files.h and poses_file.h do.
/// @param cell_size_m  edge of a cell, > 0.
/// @throws std::runtime_error naming the file that cannot be written.
void writeRobotFiles(const std::string& folder, const mapping::LocalBelief& belief, double cell_size_m,
                     const std::vector<mapping::StampedPose>& path);

}  // namespace shoal::robot_agent
