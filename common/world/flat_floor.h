// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "shoal/world/observation.h"

namespace shoal::world {

/// What a depth camera would see of a level floor, for robots that have none: every pixel's ray meets the
/// plane Z = (the camera's Z) - altitude_m. Rays that do not meet it, or only at a depth above ten altitudes
/// (near the horizon, where a pixel covers too much), have none: 0.
/// @param altitude_m  of the camera above the floor, > 0.
/// @returns height x width, CV_32FC1, metres along the optical axis.
cv::Mat flatFloorDepth(const Intrinsics& intrinsics, const Pose& world_from_camera, double altitude_m);

}  // namespace shoal::world
