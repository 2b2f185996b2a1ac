// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "operator_console/launch_options.h"
#include "operator_console/mission_watch.h"
#include "shoal/mapping/queries.h"

namespace shoal::console {

/// A mission that has ended, as launch saw it. Its processes have written their files and are gone.
struct RunInfo {
  LaunchOptions options;                                   ///< completed(); `lcm_url` and `mission` as used
  std::map<std::string, wire::Heartbeat> last_heartbeats;  ///< by node
  std::vector<mapping::NodeStatus> nodes;                  ///< the same, for people
  MissionWatch::WorstWindow worst_window;
  bool converged = false;
  double converged_s = 0;  ///< mission time; of the latest heartbeat when it did not converge
  uint64_t state_digest = 0, map_digest = 0;  ///< of OPERATOR
};

/// Scores a mission, draws `global_map.png`, the truth beside it when the world is labelled, and writes
/// `summary.json`: the last file, so that its presence means that the run is whole.
/// @returns the score table for people; empty when the world has no truth.
/// @throws std::runtime_error naming the file that is missing, broken or cannot be written.
std::string finishRun(const RunInfo& run);

}  // namespace shoal::console
