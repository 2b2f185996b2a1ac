// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/reef_world.h"

#include <bit>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "shoal/random.h"
#include "shoal/world/reef_sight.h"

namespace shoal::world {
namespace {

constexpr double kUsualAltitude = 8.0;  // metres

uint64_t poseHash(const Pose& pose) {
  uint64_t hash = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) hash = hashCombine(hash, std::bit_cast<uint64_t>(pose(i, j)));
  }
  return hash;
}

View viewOf(const Intrinsics& intrinsics, const Pose& world_from_camera) {
  View view;
  view.width = intrinsics.width;
  view.height = intrinsics.height;
  view.view_from_world = world_from_camera.linear().transpose();
  view.eye = world_from_camera.translation();
  view.fx = intrinsics.fx;
  view.fy = intrinsics.fy;
  view.cx = intrinsics.cx;
  view.cy = intrinsics.cy;
  return view;
}

Observation blank(const Intrinsics& intrinsics, const Pose& world_from_camera) {
  const cv::Size size(intrinsics.width, intrinsics.height);
  Observation seen;
  seen.intrinsics = intrinsics;
  seen.world_from_camera = world_from_camera;
  seen.depth_m = cv::Mat(size, CV_32FC1, cv::Scalar::all(0));
  seen.labels = cv::Mat(size, CV_8UC1, cv::Scalar::all(255));
  return seen;
}

}  // namespace

ReefWorld::ReefWorld(ReefStyle style, uint64_t seed)
    : scene_(std::move(style), seed), water_(scene_.style().water) {
  for (const ReefClass& c : scene_.style().classes) classes_.push_back(c.truth);
}

Observation ReefWorld::render(const Intrinsics& intrinsics, const Pose& world_from_camera) const {
  checkCamera(intrinsics, world_from_camera);
  const ReefSight sight(scene_, viewOf(intrinsics, world_from_camera));
  const uint64_t key = poseHash(world_from_camera);
  Random random(key);
  // The waves have moved on from one picture to the next.
  const std::array<float, 2> waves{20.0f + 10.0f * static_cast<float>(random.uniform()),
                                   20.0f + 10.0f * static_cast<float>(random.uniform())};
  const Eigen::Matrix3f turn = world_from_camera.linear().cast<float>();
  const Eigen::Vector3f along_row = turn.col(0) / static_cast<float>(intrinsics.fx);
  const Eigen::Vector3f eye = world_from_camera.translation().cast<float>();
  const float middle_x = 0.5f * static_cast<float>(intrinsics.width - 1),
              middle_y = 0.5f * static_cast<float>(intrinsics.height - 1);
  const float per_corner = 1.0f / (middle_x * middle_x + middle_y * middle_y + 1.0f);

  Observation seen = blank(intrinsics, world_from_camera);
  Film film(intrinsics.width, intrinsics.height);
  for (int v = 0; v < intrinsics.height; ++v) {
    const float* depth = sight.raster().depths(v);
    float* depth_m = seen.depth_m.ptr<float>(v);
    uint8_t* labels = seen.labels.ptr<uint8_t>(v);
    const Eigen::Vector3f row_ray = turn * intrinsics.unproject(0, v, 1.0).cast<float>();
    for (int u = 0; u < intrinsics.width; ++u) {
      if (depth[u] == Raster::kNothing) continue;
      const Eigen::Vector3f ray = row_ray + static_cast<float>(u) * along_row;
      const ReefPoint point = sight.at(v, u, eye + depth[u] * ray, waves);
      Color light = water_.seen(point.color, depth[u] * std::sqrt(ray.squaredNorm()));
      const float x = static_cast<float>(u) - middle_x, y = static_cast<float>(v) - middle_y;
      const float vignette = 1.0f - 0.38f * (x * x + y * y) * per_corner;
      for (float& channel : light) channel *= vignette;
      film.at(v, u) = light;
      depth_m[u] = depth[u];
      labels[u] = point.label;
    }
  }
  film.expose();
  film.soften();
  seen.color = film.develop(key);
  seen.color.setTo(cv::Scalar::all(0), seen.labels == 255);
  return seen;
}

Observation ReefWorld::fromAbove(const Extent& area, double metres_per_pixel) const {
  if (!(metres_per_pixel > 0.0) || !std::isfinite(metres_per_pixel)) {
    throw std::invalid_argument("metres_per_pixel must be finite and > 0, got " +
                                std::to_string(metres_per_pixel));
  }
  constexpr double kMost = 50.0, kSide = ReefScene::kSide;
  const double width = area.max_x - area.min_x, height = area.max_y - area.min_y;
  if (!(width > 0.0 && width <= kMost && height > 0.0 && height <= kMost && area.min_x >= 0.0 &&
        area.max_x <= kSide && area.min_y >= -kSide && area.max_y <= 0.0)) {
    throw std::invalid_argument("a map's area must lie in the reef and be at most 50 m a side, got " +
                                std::to_string(width) + " x " + std::to_string(height) + " m");
  }
  // From so far up that rays are parallel but for millimetres.
  constexpr double kUp = 8000.0;
  Intrinsics camera;
  camera.width = std::max(1, static_cast<int>(std::lround(width / metres_per_pixel)));
  camera.height = std::max(1, static_cast<int>(std::lround(height / metres_per_pixel)));
  camera.fx = camera.fy = kUp / metres_per_pixel;
  camera.cx = 0.5 * (camera.width - 1);
  camera.cy = 0.5 * (camera.height - 1);
  const Pose pose = lookingDown({0.5 * (area.min_x + area.max_x), 0.5 * (area.min_y + area.max_y), kUp});
  checkCamera(camera, pose);
  const ReefSight sight(scene_, viewOf(camera, pose));
  Observation seen = blank(camera, pose);
  Film film(camera.width, camera.height);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const float depth = sight.raster().depths(v)[u];
      if (depth == Raster::kNothing) continue;
      const Eigen::Vector3d p = pose * camera.unproject(u, v, static_cast<double>(depth));
      const ReefPoint point = sight.at(v, u, p.cast<float>(), {20.0f, 20.0f});
      film.at(v, u) = water_.seen(point.color, static_cast<float>(std::max(0.0, kUsualAltitude - p.z())));
      seen.depth_m.at<float>(v, u) = static_cast<float>(p.z());
      seen.labels.at<uint8_t>(v, u) = point.label;
    }
  }
  seen.color = film.develop(0);
  return seen;
}

}  // namespace shoal::world
