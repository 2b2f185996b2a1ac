// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "shoal/world/ids.h"

namespace shoal::console {

/// A crash on schedule, or the end of one.
struct KillStep {
  double at_s = 0;  ///< mission time
  world::RobotId robot{};
  bool restart = false;  ///< else it is killed
  bool anew = false;     ///< it has lost its disk too
};

/// Reads a plan: a line a step, `t_s ROBOT kill|restart|anew`; empty lines and those that begin with # are
/// passed over. Of each robot, times grow and every kill is followed by a restart: nobody else can say a
/// robot's pieces again, so without it nodes that heard different parts of them would never agree.
/// @returns the steps in the order of the file.
/// @throws std::invalid_argument naming the file and the line.
std::vector<KillStep> readKillPlan(const std::string& path, int num_robots);

}  // namespace shoal::console
