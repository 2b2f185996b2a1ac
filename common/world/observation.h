// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "shoal/world/ids.h"
#include "shoal/world/pose.h"

namespace shoal::world {

/// A pinhole camera without distortion. Pixel index = pixel centre.
struct Intrinsics {
  int width = 320;                ///< pixels
  int height = 240;               ///< pixels
  double fx = 200.0, fy = 200.0;  ///< focal lengths, pixels
  double cx = 159.5, cy = 119.5;  ///< principal point, pixels

  /// The point at depth `depth_m` along the optical axis seen at pixel (u, v), camera frame, metres.
  Eigen::Vector3d unproject(double u, double v, double depth_m) const {
    return {(u - cx) / fx * depth_m, (v - cy) / fy * depth_m, depth_m};
  }
};

/// One localised RGB-D image.
struct Observation {
  int32_t number = 0;  ///< 0-based, counts this robot's frames
  Timestamp time;      ///< mission time of the measurement
  cv::Mat color;       ///< height x width, CV_8UC3, BGR
  cv::Mat depth_m;     ///< height x width, CV_32FC1, metres along the optical axis; <= 0 or not finite = none
  cv::Mat labels;  ///< truth for scoring only: height x width, CV_8UC1, 255 = unlabelled; empty when unknown
  Intrinsics intrinsics;
  Pose world_from_camera = Pose::Identity();
};

}  // namespace shoal::world
