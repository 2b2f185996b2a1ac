// SPDX-License-Identifier: BSD-3-Clause
#include "robot_agent/lone_robot.h"

#include <vector>

#include <spdlog/spdlog.h>

#include "fusion_node/process.h"
#include "robot_agent/robot_files.h"

namespace shoal::robot_agent {

void runAlone(const robot::ExplorerOptions& options, world::ObservationSource& source,
              const std::string& out_dir) {
  robot::Explorer explorer(options);
  std::vector<mapping::StampedPose> path;
  const int32_t total = source.numObservations().value_or(0);
  while (!fusion_node::stopRequested()) {
    const auto observation = source.next();
    if (!observation) break;
    explorer.observe(*observation);
    path.push_back({observation->time, observation->world_from_camera});
    if (path.size() % 10 == 0) spdlog::info("{} of {} observations", path.size(), total);
  }
  const mapping::LocalBelief belief = explorer.belief();
  writeRobotFiles(out_dir, belief, options.cell_size_m, path);
  spdlog::info("flew {} observations alone: {} topics, {} cells", path.size(), belief.topics.size(),
               belief.cells.size());
}

}  // namespace shoal::robot_agent
