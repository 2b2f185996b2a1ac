// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace shoal::comms {

/// Where a robot's cameras speak: channels of its own choosing but for the ending. docs/cameras.md.
struct CameraChannels {
  /// @param prefix  [A-Za-z0-9_]{1,56}, not beginning with SHOAL_. @throws std::invalid_argument naming it.
  explicit CameraChannels(const std::string& prefix);

  std::string image;    ///< PREFIX_IMAGE: image_t, colour
  std::string depth;    ///< PREFIX_DEPTH: image_t, 16-bit depth
  std::string images;   ///< PREFIX_IMAGES: images_t, colour and depth of one time
  std::string pose;     ///< PREFIX_POSE: pose_t or rigid_transform_t
  std::string vehicle;  ///< PREFIX_STATUS: vehicle_t, battery and depth

  std::vector<std::string> all() const { return {image, depth, images, pose, vehicle}; }
};

}  // namespace shoal::comms
