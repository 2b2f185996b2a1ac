// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/survey.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace shoal::world {
namespace {

/// What a camera that looks straight down from `altitude_m` sees of Z = 0, at yaw 0: edges in metres, and
/// where the middle lies relative to the camera (the principal point may be off centre).
struct Footprint {
  double width, height, offset_x, offset_y;
};

Footprint footprint(const Intrinsics& intrinsics, double altitude_m) {
  const double x_per_px = altitude_m / intrinsics.fx, y_per_px = altitude_m / intrinsics.fy;
  return {intrinsics.width * x_per_px, intrinsics.height * y_per_px,
          (0.5 * (intrinsics.width - 1) - intrinsics.cx) * x_per_px,
          -(0.5 * (intrinsics.height - 1) - intrinsics.cy) * y_per_px};
}

/// Middles of `count` windows over [low, high], evenly spread: flush with both ends when they can overlap,
/// with equal gaps when they cannot.
double middle(double low, double high, double window, int64_t count, int64_t i) {
  const double length = high - low;
  if (count <= 1 || window >= length) return 0.5 * (low + high);
  if (static_cast<double>(count) * window <= length) {
    return low + (static_cast<double>(i) + 0.5) * length / static_cast<double>(count);
  }
  return low + 0.5 * window + (length - window) * static_cast<double>(i) / static_cast<double>(count - 1);
}

/// How `observations` are dealt to legs: along Y (or along X when `along_x`), the first legs one more.
struct Legs {
  bool along_x = false;
  int64_t count = 1;
};

/// The best way to fly: covers most, then has the least of the worse spacing, along and across, relative to
/// the footprint, then has the fewest legs.
Legs chooseLegs(double width, double height, const Footprint& seen, int64_t observations) {
  Legs best;
  double best_covered = -1.0, best_spacing = 0.0;
  for (int64_t count = 1; count <= observations; ++count) {
    for (const bool along_x : {false, true}) {
      const double across = along_x ? height / seen.height : width / seen.width;
      const double along = along_x ? width / seen.width : height / seen.height;
      const double legs = static_cast<double>(count);
      const double shorter = static_cast<double>(observations / count);
      const double longer_share = static_cast<double>(observations % count) / legs;
      const double covered_by_leg = (1.0 - longer_share) * std::min(1.0, shorter / along) +
                                    longer_share * std::min(1.0, (shorter + 1.0) / along);
      const double covered = std::min(1.0, legs / across) * covered_by_leg;
      const double spacing = std::max(across / legs, along / shorter);
      constexpr double kAlike = 1e-9;
      if (covered > best_covered + kAlike ||
          (covered > best_covered - kAlike && spacing < best_spacing - kAlike)) {
        best = {along_x, count};
        best_covered = covered;
        best_spacing = spacing;
      }
    }
  }
  return best;
}

double altitudeOf(const World& world, const SurveyOptions& options) {
  return options.altitude_m > 0.0 ? options.altitude_m : options.intrinsics.fx * world.metresPerPixel();
}

/// As many windows as cover `length` when neighbours overlap by 30 % or more.
int32_t windowsFor(double length, double window) {
  constexpr double kStep = 0.7;
  return 1 + static_cast<int32_t>(std::max(0.0, std::ceil((length - window) / (kStep * window) - 1e-9)));
}

void check(const Intrinsics& intrinsics, double altitude_m) {
  checkCamera(intrinsics, Pose::Identity());
  if (!(altitude_m > 0.0) || !std::isfinite(altitude_m)) {
    throw std::invalid_argument("altitude must be finite and > 0 m, got " + std::to_string(altitude_m));
  }
}

class SurveySource final : public ObservationSource {
 public:
  SurveySource(const World& world, std::vector<Pose> path, const Intrinsics& intrinsics,
               double frame_period_s)
      : world_(world), path_(std::move(path)), intrinsics_(intrinsics), frame_period_s_(frame_period_s) {}

  std::optional<Observation> next() override {
    if (next_ >= path_.size()) return std::nullopt;
    Observation seen = world_.render(intrinsics_, path_[next_]);
    seen.number = static_cast<int32_t>(next_);
    seen.time.us = std::llround(static_cast<double>(next_) * frame_period_s_ * 1e6);
    ++next_;
    return seen;
  }

  std::optional<int32_t> numObservations() const override { return static_cast<int32_t>(path_.size()); }

 private:
  const World& world_;
  const std::vector<Pose> path_;
  const Intrinsics intrinsics_;
  const double frame_period_s_;
  size_t next_ = 0;
};

}  // namespace

std::vector<Pose> lawnmower(const Extent& share, int32_t observations, double altitude_m,
                            const Intrinsics& intrinsics) {
  check(intrinsics, altitude_m);
  if (observations < 1) {
    throw std::invalid_argument("observations must be >= 1, got " + std::to_string(observations));
  }
  const Footprint seen = footprint(intrinsics, altitude_m);
  const Legs legs = chooseLegs(share.max_x - share.min_x, share.max_y - share.min_y, seen, observations);
  std::vector<Pose> path;
  path.reserve(static_cast<size_t>(observations));
  for (int64_t leg = 0; leg < legs.count; ++leg) {
    const int64_t frames = observations / legs.count + (leg < observations % legs.count ? 1 : 0);
    for (int64_t frame = 0; frame < frames; ++frame) {
      const int64_t along = leg % 2 == 0 ? frame : frames - 1 - frame;  // there and back
      const auto x = [&](int64_t count, int64_t i) {
        return middle(share.min_x, share.max_x, seen.width, count, i) - seen.offset_x;
      };
      const auto y = [&](int64_t count, int64_t i) {
        return middle(share.min_y, share.max_y, seen.height, count, count - 1 - i) - seen.offset_y;
      };
      path.push_back(lookingDown(legs.along_x
                                     ? Eigen::Vector3d(x(frames, along), y(legs.count, leg), altitude_m)
                                     : Eigen::Vector3d(x(legs.count, leg), y(frames, along), altitude_m)));
    }
  }
  return path;
}

double coverage(const Extent& share, const std::vector<Pose>& path, const Intrinsics& intrinsics) {
  constexpr int kSamples = 300;  // per side
  std::vector<Pose> camera_from_world;
  for (const Pose& pose : path) camera_from_world.push_back(pose.inverse());
  const auto sees = [&](const Pose& from_world, const Eigen::Vector3d& p_in_world) {
    const Eigen::Vector3d p = from_world * p_in_world;
    if (!(p.z() > 0.0)) return false;
    const double u = intrinsics.fx * p.x() / p.z() + intrinsics.cx;
    const double v = intrinsics.fy * p.y() / p.z() + intrinsics.cy;
    constexpr double kEdge = 0.5 + 1e-6;
    return u >= -kEdge && u <= intrinsics.width - 1 + kEdge && v >= -kEdge &&
           v <= intrinsics.height - 1 + kEdge;
  };
  int covered = 0;
  size_t last = 0;  // neighbours are mostly seen by the same camera: ask that one first
  for (int row = 0; row < kSamples; ++row) {
    for (int column = 0; column < kSamples; ++column) {
      const Eigen::Vector3d p(share.min_x + (column + 0.5) / kSamples * (share.max_x - share.min_x),
                              share.min_y + (row + 0.5) / kSamples * (share.max_y - share.min_y), 0.0);
      for (size_t i = 0; i < path.size(); ++i) {
        const size_t camera = (last + i) % path.size();
        if (!sees(camera_from_world[camera], p)) continue;
        last = camera;
        ++covered;
        break;
      }
    }
  }
  return static_cast<double>(covered) / (kSamples * kSamples);
}

std::vector<Pose> surveyPath(const World& world, const SurveyOptions& options, int robot, bool single) {
  if (!single && (robot < 0 || robot >= options.num_robots)) {
    throw std::invalid_argument("robot must be in [0, " + std::to_string(options.num_robots) + "), got " +
                                std::to_string(robot));
  }
  if (options.observations < 0) {
    throw std::invalid_argument("observations must be >= 0 (0 = as many as cover the share), got " +
                                std::to_string(options.observations));
  }
  if (!(options.altitude_m >= 0.0) || !(options.cell_size_m >= 0.0)) {
    throw std::invalid_argument("altitude and cell size must be >= 0 m (0 = the world's default)");
  }
  const double altitude_m = altitudeOf(world, options);
  check(options.intrinsics, altitude_m);
  const Grid grid(options.cell_size_m > 0.0 ? options.cell_size_m : world.defaultCellSize());
  const std::vector<Extent> team = shares(world.extent(), options.num_robots, grid);
  std::vector<Pose> path;
  for (int r = single ? 0 : robot; r < (single ? options.num_robots : robot + 1); ++r) {
    const Extent& share = team[static_cast<size_t>(r)];
    int32_t observations = options.observations;
    if (observations == 0) {
      const Footprint seen = footprint(options.intrinsics, altitude_m);
      observations = windowsFor(share.max_x - share.min_x, seen.width) *
                     windowsFor(share.max_y - share.min_y, seen.height);
    }
    const std::vector<Pose> own = lawnmower(share, observations, altitude_m, options.intrinsics);
    path.insert(path.end(), own.begin(), own.end());
  }
  return path;
}

std::unique_ptr<ObservationSource> makeSurveySource(const World& world, std::vector<Pose> path,
                                                    const Intrinsics& intrinsics, double frame_period_s) {
  if (!(frame_period_s > 0.0) || !std::isfinite(frame_period_s)) {
    throw std::invalid_argument("frame period must be finite and > 0 s, got " +
                                std::to_string(frame_period_s));
  }
  return std::make_unique<SurveySource>(world, std::move(path), intrinsics, frame_period_s);
}

}  // namespace shoal::world
