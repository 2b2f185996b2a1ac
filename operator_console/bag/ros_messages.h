// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <opencv2/core/mat.hpp>

namespace shoal::console {

/// Seconds since 1970, as ROS stamps them. Microseconds, >= 0.
struct RosStamp {
  int64_t us = 0;
};

struct RosPicture {
  RosStamp stamp;
  cv::Mat pixels;  ///< CV_8UC3 (BGR), or CV_16UC1: depth in millimetres, 0 = none
};

struct RosCamera {
  uint32_t width = 0, height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  bool distorted = false;
};

struct RosPose {
  RosStamp stamp;
  std::array<double, 3> position{};     ///< metres
  std::array<double, 4> orientation{};  ///< x y z w
};

/// What is read of sensor_msgs/Image (rgb8, bgr8, rgba8, bgra8, mono8; as depth 16UC1, mono16, 32FC1) and of
/// sensor_msgs/CompressedImage (what OpenCV decodes; as depth "16UC1; compressedDepth" in PNG). Bytes of a
/// message are anything: nothing is returned, and `trouble` says why, when they are no such picture. Sides
/// are at most 8192 pixels.
std::optional<RosPicture> readImage(std::span<const uint8_t> cdr, bool depth, std::string& trouble);
std::optional<RosPicture> readCompressedImage(std::span<const uint8_t> cdr, bool depth, std::string& trouble);

/// sensor_msgs/CameraInfo, from its K.
std::optional<RosCamera> readCameraInfo(std::span<const uint8_t> cdr, std::string& trouble);

/// nav_msgs/Odometry (`odometry`), geometry_msgs/PoseStamped or PoseWithCovarianceStamped.
std::optional<RosPose> readPose(std::span<const uint8_t> cdr, bool odometry, std::string& trouble);

}  // namespace shoal::console
