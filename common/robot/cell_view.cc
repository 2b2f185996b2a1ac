// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/robot/cell_view.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace shoal::robot {
namespace {

constexpr double kCellsWide = 2.0;
constexpr int kLeastSide = 8;  // pixels

}  // namespace

std::optional<CellView> viewOf(const world::Observation& observation, const world::CellIndex& cell,
                               const world::Grid& grid) {
  const world::Intrinsics& camera = observation.intrinsics;
  const Eigen::Vector3d p_in_camera = observation.world_from_camera.inverse() * grid.centerOf(cell);
  if (!(p_in_camera.z() > 0)) return std::nullopt;
  const double u = camera.fx * p_in_camera.x() / p_in_camera.z() + camera.cx;
  const double v = camera.fy * p_in_camera.y() / p_in_camera.z() + camera.cy;
  const double side = kCellsWide * grid.cellSize() * camera.fx / p_in_camera.z();
  const cv::Size size = observation.color.size();
  // Written so that what is not a number fails.
  if (!(side >= kLeastSide && side <= std::min(size.width, size.height))) return std::nullopt;
  if (!(u >= side / 2 && v >= side / 2 && u <= size.width - side / 2 && v <= size.height - side / 2)) {
    return std::nullopt;
  }
  const int whole = static_cast<int>(side);
  const CellView view{std::clamp(static_cast<int>(u - side / 2), 0, size.width - whole),
                      std::clamp(static_cast<int>(v - side / 2), 0, size.height - whole), whole};
  if (observation.depth_m.size() != size) return std::nullopt;
  const float depth_m = observation.depth_m.at<float>(view.top + whole / 2, view.left + whole / 2);
  if (!(depth_m > 0) || !(std::abs(depth_m - p_in_camera.z()) <= grid.cellSize())) return std::nullopt;
  return view;
}

std::vector<uint8_t> cutOut(const world::Observation& observation, const CellView& view, int edge) {
  if (observation.color.type() != CV_8UC3) {
    throw std::invalid_argument("a colour image is of type CV_8UC3, got type " +
                                std::to_string(observation.color.type()));
  }
  std::vector<uint8_t> rgb;
  rgb.reserve(static_cast<size_t>(3) * static_cast<size_t>(edge * edge));
  for (int row = 0; row < edge; ++row) {
    const int top = row * view.side / edge, bottom = std::max((row + 1) * view.side / edge, top + 1);
    for (int column = 0; column < edge; ++column) {
      const int left = column * view.side / edge, right = std::max((column + 1) * view.side / edge, left + 1);
      int blue = 0, green = 0, red = 0;
      for (int y = top; y < bottom; ++y) {
        for (int x = left; x < right; ++x) {
          const auto& pixel = observation.color.at<cv::Vec3b>(view.top + y, view.left + x);
          blue += pixel[0];
          green += pixel[1];
          red += pixel[2];
        }
      }
      const int count = (bottom - top) * (right - left);
      for (const int sum : {red, green, blue}) rgb.push_back(static_cast<uint8_t>((sum + count / 2) / count));
    }
  }
  return rgb;
}

}  // namespace shoal::robot
