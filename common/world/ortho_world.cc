// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/ortho_world.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace shoal::world {
namespace {

constexpr uint8_t kUnlabelledId = 255;

/// The picture at (x, y) pixels, within half a pixel of it; eight bits of fraction, so that every machine
/// rounds alike. Beyond the outermost centres the border repeats.
cv::Vec3b bilinear(const cv::Mat& color, double x, double y) {
  const double cx = std::clamp(x, 0.0, static_cast<double>(color.cols - 1));
  const double cy = std::clamp(y, 0.0, static_cast<double>(color.rows - 1));
  const int x0 = std::min(static_cast<int>(cx), std::max(color.cols - 2, 0));
  const int y0 = std::min(static_cast<int>(cy), std::max(color.rows - 2, 0));
  const int x1 = std::min(x0 + 1, color.cols - 1);
  const int y1 = std::min(y0 + 1, color.rows - 1);
  const int fx = static_cast<int>((cx - x0) * 256.0 + 0.5);
  const int fy = static_cast<int>((cy - y0) * 256.0 + 0.5);
  const cv::Vec3b* top = color.ptr<cv::Vec3b>(y0);
  const cv::Vec3b* bottom = color.ptr<cv::Vec3b>(y1);
  cv::Vec3b mixed;
  for (int c = 0; c < 3; ++c) {
    const int above = top[x0][c] * (256 - fx) + top[x1][c] * fx;
    const int below = bottom[x0][c] * (256 - fx) + bottom[x1][c] * fx;
    mixed[c] = static_cast<uint8_t>((above * (256 - fy) + below * fy + (1 << 15)) >> 16);
  }
  return mixed;
}

}  // namespace

OrthoWorld::OrthoWorld(std::string name, cv::Mat color, cv::Mat labels, double metres_per_pixel,
                       std::vector<TruthClass> classes)
    : name_(std::move(name)),
      color_(std::move(color)),
      labels_(std::move(labels)),
      metres_per_pixel_(metres_per_pixel),
      classes_(std::move(classes)) {
  if (color_.empty() || color_.type() != CV_8UC3) {
    throw std::invalid_argument("the picture must have pixels of three 8-bit channels");
  }
  if (!(metres_per_pixel > 0.0) || !std::isfinite(metres_per_pixel)) {
    throw std::invalid_argument("metres_per_pixel must be finite and > 0, got " +
                                std::to_string(metres_per_pixel));
  }
  if (labels_.empty()) return;
  if (labels_.type() != CV_8UC1 || labels_.size() != color_.size()) {
    throw std::invalid_argument("labels must be one 8-bit channel of the picture's size, " +
                                std::to_string(color_.cols) + " x " + std::to_string(color_.rows));
  }
  std::array<bool, 256> known{};
  known[kUnlabelledId] = true;
  for (const TruthClass& c : classes_) {
    if (c.id < 0 || c.id >= kUnlabelledId || known[static_cast<size_t>(c.id)]) {
      throw std::invalid_argument("class ids must be distinct and in [0, 254], got " + std::to_string(c.id));
    }
    known[static_cast<size_t>(c.id)] = true;
  }
  for (int y = 0; y < labels_.rows; ++y) {
    const uint8_t* row = labels_.ptr<uint8_t>(y);
    const uint8_t* stranger = std::find_if(row, row + labels_.cols, [&](uint8_t id) { return !known[id]; });
    if (stranger == row + labels_.cols) continue;
    throw std::invalid_argument("label " + std::to_string(*stranger) + " at pixel (" +
                                std::to_string(stranger - row) + ", " + std::to_string(y) +
                                ") is neither a class nor 255 (unlabelled)");
  }
}

Extent OrthoWorld::extent() const {
  return {-0.5 * metres_per_pixel_, -(color_.rows - 0.5) * metres_per_pixel_,
          (color_.cols - 0.5) * metres_per_pixel_, 0.5 * metres_per_pixel_};
}

Observation OrthoWorld::render(const Intrinsics& intrinsics, const Pose& world_from_camera) const {
  checkCamera(intrinsics, world_from_camera);
  const cv::Size size(intrinsics.width, intrinsics.height);
  Observation seen;
  seen.intrinsics = intrinsics;
  seen.world_from_camera = world_from_camera;
  seen.color = cv::Mat(size, CV_8UC3, cv::Scalar::all(0));
  seen.depth_m = cv::Mat(size, CV_32FC1, cv::Scalar::all(0));
  if (hasFlatTruth()) seen.labels = cv::Mat(size, CV_8UC1, cv::Scalar::all(kUnlabelledId));

  const Eigen::Vector3d eye = world_from_camera.translation();
  for (int v = 0; v < intrinsics.height; ++v) {
    cv::Vec3b* color = seen.color.ptr<cv::Vec3b>(v);
    float* depth_m = seen.depth_m.ptr<float>(v);
    uint8_t* label = hasFlatTruth() ? seen.labels.ptr<uint8_t>(v) : nullptr;
    for (int u = 0; u < intrinsics.width; ++u) {
      // One metre along the optical axis, so that the ray's parameter at the ground is the depth.
      const Eigen::Vector3d ray = world_from_camera.linear() * intrinsics.unproject(u, v, 1.0);
      const double depth = -eye.z() / ray.z();
      if (!(depth > 0.0) || !std::isfinite(depth)) continue;  // above the horizon, or under the ground
      const double x = (eye.x() + depth * ray.x()) / metres_per_pixel_;
      const double y = -(eye.y() + depth * ray.y()) / metres_per_pixel_;
      if (!(x >= -0.5 && x < color_.cols - 0.5 && y >= -0.5 && y < color_.rows - 0.5)) continue;
      color[u] = bilinear(color_, x, y);
      depth_m[u] = static_cast<float>(depth);
      if (label != nullptr)
        label[u] = labels_.at<uint8_t>(static_cast<int>(y + 0.5), static_cast<int>(x + 0.5));
    }
  }
  return seen;
}

std::optional<uint8_t> OrthoWorld::truthOfSquare(const Grid& grid, const CellIndex& cell) const {
  if (!hasFlatTruth()) return std::nullopt;
  // In pixels; the allowance lets 24 * 0.1 m be 24 pixels although neither is exact in binary.
  const double edge = grid.cellSize() / metres_per_pixel_;
  const auto firstFrom = [](double p) { return std::ceil(p - 1e-6); };
  const auto firstAfter = [](double p) { return std::floor(p + 1e-6) + 1.0; };
  const double x0 = firstFrom((cell.x - 0.5) * edge), x1 = firstFrom((cell.x + 0.5) * edge);
  const double y0 = firstAfter(-(cell.y + 0.5) * edge), y1 = firstAfter(-(cell.y - 0.5) * edge);
  const auto within = [](double p, int size) {
    return static_cast<int>(std::clamp(p, 0.0, static_cast<double>(size)));
  };
  std::array<int64_t, 256> votes{};
  int64_t labelled = 0;
  for (int y = within(y0, labels_.rows); y < within(y1, labels_.rows); ++y) {
    const uint8_t* row = labels_.ptr<uint8_t>(y);
    for (int x = within(x0, labels_.cols); x < within(x1, labels_.cols); ++x) {
      if (row[x] == kUnlabelledId) continue;
      ++votes[row[x]];
      ++labelled;
    }
  }
  const double pixels = (x1 - x0) * (y1 - y0);
  if (labelled == 0 || 2.0 * static_cast<double>(labelled) < pixels) return kUnlabelledId;
  return static_cast<uint8_t>(std::max_element(votes.begin(), votes.end()) - votes.begin());
}

}  // namespace shoal::world
