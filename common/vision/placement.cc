// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/placement.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace shoal::vision {
namespace {

std::string sizeOf(const cv::Mat& image) {
  return std::to_string(image.cols) + "x" + std::to_string(image.rows);
}

// The cell of the surface seen at a pixel; nothing without a depth.
std::optional<world::CellIndex> cellAt(int u, int v, const world::Observation& observation,
                                       const world::Grid& grid) {
  const float depth_m = observation.depth_m.at<float>(v, u);
  if (!(depth_m > 0.0f) || !std::isfinite(depth_m)) return std::nullopt;
  const Eigen::Vector3d p_in_world =
      observation.world_from_camera * observation.intrinsics.unproject(u, v, double{depth_m});
  constexpr double kMaxIndex = 2147483000.0;  // a little inside what int32 holds
  if (!((p_in_world / grid.cellSize()).cwiseAbs().maxCoeff() < kMaxIndex)) return std::nullopt;
  return grid.cellOf(p_in_world);
}

}  // namespace

void checkObservation(const world::Observation& observation) {
  const cv::Mat& color = observation.color;
  const cv::Mat& depth_m = observation.depth_m;
  const world::Intrinsics& camera = observation.intrinsics;
  const std::string which = "observation " + std::to_string(observation.number) + ": ";
  if (color.empty() || color.type() != CV_8UC3) {
    throw std::invalid_argument(which + "the colour image must be CV_8UC3 and not empty");
  }
  if (depth_m.type() != CV_32FC1) throw std::invalid_argument(which + "the depth image must be CV_32FC1");
  if (depth_m.size() != color.size() || color.cols != camera.width || color.rows != camera.height) {
    throw std::invalid_argument(which + "colour is " + sizeOf(color) + ", depth " + sizeOf(depth_m) +
                                ", the camera " + std::to_string(camera.width) + "x" +
                                std::to_string(camera.height) + "; they must be equal");
  }
  if (!std::isfinite(camera.fx) || !std::isfinite(camera.fy) || !(camera.fx > 0.0) || !(camera.fy > 0.0) ||
      !std::isfinite(camera.cx) || !std::isfinite(camera.cy)) {
    throw std::invalid_argument(which + "intrinsics must be finite with focal lengths > 0");
  }
  if (!observation.world_from_camera.matrix().allFinite()) {
    throw std::invalid_argument(which + "the pose must be finite");
  }
}

world::WordsInCells placeWords(std::span<const PixelWord> words, const world::Observation& observation,
                               const world::Grid& grid) {
  checkObservation(observation);
  world::WordsInCells result{observation.number, observation.time, {}, 0};
  std::vector<std::pair<world::CellIndex, int32_t>> placed;
  placed.reserve(words.size());
  for (const PixelWord& word : words) {
    if (const auto cell = cellAt(word.u, word.v, observation, grid)) {
      placed.emplace_back(*cell, word.word);
    } else {
      ++result.dropped_words;
    }
  }
  std::sort(placed.begin(), placed.end());
  for (const auto& [cell, word] : placed) {
    if (result.cells.empty() || result.cells.back().cell != cell) result.cells.push_back({cell, {}});
    auto& counts = result.cells.back().words;
    if (counts.empty() || counts.back().word != word) counts.push_back({word, 0});
    ++counts.back().count;
  }
  return result;
}

}  // namespace shoal::vision
