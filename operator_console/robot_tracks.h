// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "operator_console/mission_sources.h"

namespace shoal::console {

struct TrackPoint {
  double time_s = 0;           ///< mission time
  double x = 0, y = 0, z = 0;  ///< metres, world
  bool operator==(const TrackPoint&) const = default;
};

/// Where each robot was, ascending by time, each time once: of a run from its robots' own poses.txt, else
/// from the heartbeats of what was heard. Robots of which less than two places are known are left out.
/// @throws std::runtime_error naming the file that is broken; as readRecording().
std::map<std::string, std::vector<TrackPoint>> tracksOf(const Where& where);

}  // namespace shoal::console
