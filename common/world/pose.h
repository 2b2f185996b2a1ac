// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

namespace shoal::world {

/// A rigid transform, named for what it does: `p_in_world = world_from_camera * p_in_camera`.
/// Camera: x right, y down, z forward along the optical axis. World: Z up, ground at 0, metres.
using Pose = Eigen::Isometry3d;

/// The pose at `position` (metres, world) that looks straight down with image "up" along world heading
/// `yaw_rad` measured from +Y counter-clockwise: at yaw 0 image x is world +X and image y is world -Y.
inline Pose lookingDown(const Eigen::Vector3d& position, double yaw_rad = 0.0) {
  Pose world_from_camera = Pose::Identity();
  world_from_camera.translation() = position;
  Eigen::Matrix3d down;
  down << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  world_from_camera.linear() = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix() * down;
  return world_from_camera;
}

}  // namespace shoal::world
