// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>

namespace shoal::console {

struct ImportOptions {
  std::string bag;     ///< as readBag() reads them
  std::string folder;  ///< made; must not hold anything
  /// Topics; empty: the only one of its kind, where a depth picture is one whose topic says "depth".
  std::string image, depth, pose, info;
  std::string camera;  ///< a camera.json to be copied in place of what CameraInfo says; empty = CameraInfo
  /// The camera's optical frame on the body that the poses are of: metres, then x y z w; nothing when the
  /// poses are the camera's.
  std::array<double, 7> body_from_camera = {0, 0, 0, 0, 0, 0, 1};
};

struct Imported {
  std::string image, depth, pose, info;  ///< the topics; empty = none
  int64_t images = 0, depths = 0, poses = 0;
  std::map<std::string, int64_t> left_out;  ///< messages, by why
  bool distorted = false;                   ///< CameraInfo has distortion, which nobody takes out
};

/// Writes one robot's recording in TUM layout (docs/cameras.md) of a ROS 2 bag: rgb/ and depth/ as PNG,
/// rgb.txt, depth.txt, groundtruth.txt, camera.json. Depth is optional, in millimetres. The bag is read
/// twice.
/// @throws std::invalid_argument when a topic is not there, or several could be meant: names them;
///         std::runtime_error as readBag(), and naming a file that cannot be written.
Imported importBag(const ImportOptions& options);

}  // namespace shoal::console
