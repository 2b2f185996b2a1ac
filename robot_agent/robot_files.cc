// SPDX-License-Identifier: BSD-3-Clause
#include "robot_agent/robot_files.h"

#include "shoal/mapping/atomic_file.h"
#include "shoal/mapping/belief_files.h"
#include "shoal/world/grid.h"

namespace shoal::robot_agent {

void writeRobotFiles(const std::string& folder, const mapping::LocalBelief& belief, double cell_size_m,
                     const std::vector<mapping::StampedPose>& path) {
  mapping::writeBelief(folder, belief, world::Grid(cell_size_m));
  mapping::writeFileAtomically(folder + "/poses.txt", mapping::posesTxt(path));
}

}  // namespace shoal::robot_agent
