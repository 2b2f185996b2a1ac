// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/flat_floor.h"

namespace shoal::world {

cv::Mat flatFloorDepth(const Intrinsics& intrinsics, const Pose& world_from_camera, double altitude_m) {
  constexpr double kFarthest = 10.0;  // altitudes
  cv::Mat depth_m(intrinsics.height, intrinsics.width, CV_32FC1, cv::Scalar(0));
  for (int v = 0; v < intrinsics.height; ++v) {
    auto* row = depth_m.ptr<float>(v);
    for (int u = 0; u < intrinsics.width; ++u) {
      // One metre along the optical axis, so that the ray's parameter at the floor is the depth.
      const double falls = -(world_from_camera.linear() * intrinsics.unproject(u, v, 1.0)).z();
      if (falls * kFarthest < 1.0) continue;
      row[u] = static_cast<float>(altitude_m / falls);
    }
  }
  return depth_m;
}

}  // namespace shoal::world
