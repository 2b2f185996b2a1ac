// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/reef_world.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "shoal/random.h"

namespace shoal::world {
namespace {

/// What the water leaves of a colour, and what it adds, at a range; by table, for exp() is slow.
/// Source: the usual image formation under water, J e^(-c r) + B (1 - e^(-b r)); coefficients about those of
/// clear coastal water, see Akkaynak and Treibitz, CVPR 2018.
class Water {
 public:
  struct Effect {
    Color kept, added;
  };

  Water() {
    constexpr Color kAttenuation{.085f, .030f, .025f}, kBackscatter{.035f, .045f, .050f};  // per metre
    constexpr Color kVeil{.10f, .32f, .38f}, kGain{1.55f, 1.05f, 1.0f};  // gain: white balance
    for (size_t i = 0; i < table_.size(); ++i) {
      const float range_m = static_cast<float>(i) / kPerMetre;
      for (size_t c = 0; c < 3; ++c) {
        table_[i].kept[c] = 255.0f * kGain[c] * std::exp(-kAttenuation[c] * range_m);
        table_[i].added[c] = 255.0f * kVeil[c] * (1.0f - std::exp(-kBackscatter[c] * range_m));
      }
    }
  }

  const Effect& at(float range_m) const {
    return table_[static_cast<size_t>(std::min(range_m * kPerMetre, static_cast<float>(table_.size() - 1)))];
  }

 private:
  static constexpr float kPerMetre = 16.0f;
  std::array<Effect, 1024> table_;  // to 64 m, beyond which the water is all there is to see
};

uint64_t poseHash(const Pose& pose) {
  uint64_t hash = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) hash = hashCombine(hash, std::bit_cast<uint64_t>(pose(i, j)));
  }
  return hash;
}

/// Depth along the optical axis at which a ray (one metre of it per metre of depth) meets the surface, to
/// half a millimetre; 0 when it does not. `guess_m` is a height to begin with.
double meet(const ReefSurface& surface, const Eigen::Vector3d& eye, const Eigen::Vector3d& ray,
            float guess_m) {
  if (!(ray.z() < 0.0)) return 0.0;
  const auto below = [&](double depth) {  // how far the ray has sunk under the surface
    const Eigen::Vector3d p = eye + depth * ray;
    return surface.heightAt(static_cast<float>(p.x()), static_cast<float>(p.y())) - p.z();
  };
  constexpr double kClose = 5e-4;
  // Steps straight down to the height under the point: converges where the surface is flatter than the ray.
  double depth = (guess_m - eye.z()) / ray.z();
  for (int i = 0; i < 6; ++i) {
    const double sunk = below(depth);
    if (std::abs(sunk) < kClose) return depth > 0.0 ? depth : 0.0;
    depth += sunk / ray.z();
  }
  // Halving between the highest and the lowest that the surface gets: always converges.
  double above = std::max(0.0, (ReefSurface::kMaxHeight - eye.z()) / ray.z());
  double under = (ReefSurface::kMinHeight - eye.z()) / ray.z();
  if (!(under > above) || below(above) > 0.0) return 0.0;  // the camera is under the ground
  depth = 0.5 * (above + under);
  for (double sunk = below(depth); std::abs(sunk) >= kClose && under - above > 1e-9 * under;
       sunk = below(depth)) {
    (sunk > 0.0 ? under : above) = depth;
    depth = 0.5 * (above + under);
  }
  return depth;
}

}  // namespace

ReefWorld::ReefWorld(ReefStyle style, uint64_t seed) : surface_(std::move(style), seed) {
  for (const ReefClass& c : surface_.style().classes) classes_.push_back(c.truth);
}

Observation ReefWorld::render(const Intrinsics& intrinsics, const Pose& world_from_camera) const {
  static const Water water;
  checkCamera(intrinsics, world_from_camera);
  const cv::Size size(intrinsics.width, intrinsics.height);
  Observation seen;
  seen.intrinsics = intrinsics;
  seen.world_from_camera = world_from_camera;
  seen.color = cv::Mat(size, CV_8UC3, cv::Scalar::all(0));
  seen.depth_m = cv::Mat(size, CV_32FC1, cv::Scalar::all(0));
  seen.labels = cv::Mat(size, CV_8UC1, cv::Scalar::all(255));

  const Eigen::Vector3d eye = world_from_camera.translation();
  const uint64_t grain_key = poseHash(world_from_camera);
  for (int v = 0; v < intrinsics.height; ++v) {
    cv::Vec3b* color = seen.color.ptr<cv::Vec3b>(v);
    float* depth_m = seen.depth_m.ptr<float>(v);
    uint8_t* label = seen.labels.ptr<uint8_t>(v);
    float guess_m = 0.0f;
    for (int u = 0; u < intrinsics.width; ++u) {
      const Eigen::Vector3d ray = world_from_camera.linear() * intrinsics.unproject(u, v, 1.0);
      const double depth = meet(surface_, eye, ray, guess_m);
      const Eigen::Vector3d p = eye + depth * ray;
      const bool hit = depth > 0.0 && p.x() >= 0.0 && p.x() < ReefSurface::kSide &&
                       p.y() > -ReefSurface::kSide && p.y() <= 0.0;
      if (!hit) continue;
      guess_m = static_cast<float>(p.z());
      const SeabedPoint point = surface_.at(static_cast<float>(p.x()), static_cast<float>(p.y()));
      const Water::Effect& effect = water.at(static_cast<float>(depth * ray.norm()));
      // Two 10-bit draws a channel make triangular noise; three grey levels of it, give or take.
      const uint64_t grain = mix64(grain_key + static_cast<uint64_t>(v) * 65536 + static_cast<uint64_t>(u));
      for (size_t c = 0; c < 3; ++c) {
        const auto draw = [&](size_t i) { return static_cast<float>(grain >> (10 * i) & 1023); };
        const float noise = (draw(2 * c) + draw(2 * c + 1) - 1023.0f) * (7.0f / 1023.0f);
        const float value = point.color[c] * effect.kept[c] + effect.added[c] + noise + 0.5f;
        color[u][static_cast<int>(2 - c)] = static_cast<uint8_t>(std::clamp(value, 0.0f, 255.0f));
      }
      depth_m[u] = static_cast<float>(depth);
      label[u] = point.label;
    }
  }
  return seen;
}

}  // namespace shoal::world
