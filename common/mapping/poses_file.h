// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "shoal/world/ids.h"
#include "shoal/world/pose.h"

namespace shoal::mapping {

struct StampedPose {
  world::Timestamp time;
  world::Pose world_from_camera = world::Pose::Identity();
};

/// A path in TUM format, a line a frame: `timestamp tx ty tz qx qy qz qw`, seconds and metres, camera to
/// world.
std::string posesTxt(const std::vector<StampedPose>& poses);

/// Reads TUM poses; lines that start with # are skipped.
/// @throws std::runtime_error naming the file and line that is not eight numbers.
std::vector<StampedPose> readPoses(const std::string& path);

}  // namespace shoal::mapping
