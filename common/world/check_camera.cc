// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <stdexcept>
#include <string>

#include "shoal/world/world.h"

namespace shoal::world {

void checkCamera(const Intrinsics& intrinsics, const Pose& world_from_camera) {
  constexpr int kMaxSide = 16384;
  const auto side = [](int pixels) { return pixels >= 1 && pixels <= kMaxSide; };
  const auto focal = [](double f) { return f > 0.0 && std::isfinite(f); };
  if (!side(intrinsics.width) || !side(intrinsics.height)) {
    throw std::invalid_argument("camera width and height must be in [1, 16384] pixels, got " +
                                std::to_string(intrinsics.width) + " x " + std::to_string(intrinsics.height));
  }
  if (!focal(intrinsics.fx) || !focal(intrinsics.fy)) {
    throw std::invalid_argument("camera fx and fy must be finite and > 0 pixels, got " +
                                std::to_string(intrinsics.fx) + ", " + std::to_string(intrinsics.fy));
  }
  if (!std::isfinite(intrinsics.cx) || !std::isfinite(intrinsics.cy)) {
    throw std::invalid_argument("camera cx and cy must be finite");
  }
  if (!world_from_camera.matrix().allFinite()) throw std::invalid_argument("camera pose must be finite");
}

}  // namespace shoal::world
