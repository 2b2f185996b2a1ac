// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "shoal/world/observation.h"
#include "shoal/world/world.h"

namespace shoal::world {

/// A camera as camera.json describes it.
struct Camera {
  Intrinsics intrinsics;
  std::optional<double> depth_factor;        ///< metres = 16-bit depth / factor, > 0
  std::optional<double> max_depth_m;         ///< depths beyond are none, > 0
  std::vector<TruthClass> classes;           ///< of the label images, perhaps none
  int unlabelled = 255;                      ///< value in label images that is no class
  Pose body_from_camera = Pose::Identity();  ///< for live poses, which are the body's
};

/// Reads camera.json: {"width", "height", "fx", "fy", "cx", "cy"} (pixels; pinhole without distortion, pixel
/// index = pixel centre), and, each perhaps absent, "depth_factor", "max_depth_m", "classes" [{id, name,
/// rgb}], "unlabelled", "body_from_camera" {"translation_m": [x, y, z], "quaternion_wxyz": [w, x, y, z]}.
/// Other keys are ignored.
/// @throws std::invalid_argument naming the file and what would be right.
Camera readCamera(const std::filesystem::path& file);

/// The same from the text of such a file; `origin` stands for its name in messages.
Camera parseCamera(const std::string& json_text, const std::filesystem::path& origin);

/// `own` with what `given` says instead: intrinsics and mounting always, the rest where it says something.
Camera overridden(Camera own, const Camera& given);

}  // namespace shoal::world
