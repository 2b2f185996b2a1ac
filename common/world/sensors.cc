// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/sensors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "shoal/demand.h"
#include "shoal/random.h"
#include "shoal/world/noise.h"

namespace shoal::world {
namespace {

/// Which sensor a random number is for; a number, once given, keeps its meaning.
enum Sensor : uint64_t { kCamera = 1, kDrift, kDepthNoise, kDepthHoles };

/// Nearly normal, mean 0, variance 1, within six of it: Irwin-Hall. Additions only, so alike everywhere.
double normal(Random& random) {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += random.uniform();
  return sum;
}

double between(Random& random, double low, double high) { return low + (high - low) * random.uniform(); }

/// For each channel (blue, green, red), what becomes of each of the 256 values.
cv::Mat responseOf(const SensorOptions& options, Random random) {
  const double brightness = std::exp(between(random, -1.0, 1.0) * std::log1p(options.exposure));
  cv::Mat response(1, 256, CV_8UC3);
  for (int c = 0; c < 3; ++c) {
    const double gain = brightness * between(random, 1.0 - options.color_cast, 1.0 + options.color_cast);
    for (int value = 0; value < 256; ++value) {
      response.at<cv::Vec3b>(value)[c] = static_cast<uint8_t>(std::min(255.0, gain * value + 0.5));
    }
  }
  return response;
}

/// A turn about the vertical through `p`, then a shift. The turn is given by the tangent of its half.
Pose turnAbout(const Eigen::Vector3d& p, double half_turn, double shift_x, double shift_y) {
  const double squared = half_turn * half_turn;
  const double cosine = (1.0 - squared) / (1.0 + squared), sine = 2.0 * half_turn / (1.0 + squared);
  Pose moved = Pose::Identity();
  moved.linear() << cosine, -sine, 0, sine, cosine, 0, 0, 0, 1;
  moved.translation() = p - moved.linear() * p + Eigen::Vector3d(shift_x, shift_y, 0.0);
  return moved;
}

void addDepthNoise(cv::Mat& depth_m, double noise, Random random) {
  // The difference of two uniform 16-bit draws: triangular, of variance 1/6 on (-1, 1).
  const float scale = static_cast<float>(noise * std::sqrt(6.0) / 65536.0);
  for (int v = 0; v < depth_m.rows; ++v) {
    float* row = depth_m.ptr<float>(v);
    for (int u = 0; u < depth_m.cols; ++u) {
      const uint64_t bits = random();
      const auto draw = [&](int i) { return static_cast<float>(bits >> (16 * i) & 0xffff); };
      row[u] *= 1.0f + scale * (draw(0) - draw(1));
    }
  }
}

/// Ragged patches: where smooth noise, known every four pixels, is highest.
void losePatches(cv::Mat& depth_m, double part, uint64_t key) {
  constexpr int kStep = 4;
  constexpr float kWidth = 9.0f;  // of a patch, in steps
  const int columns = depth_m.cols / kStep + 2, rows = depth_m.rows / kStep + 2;
  std::vector<float> height(static_cast<size_t>(columns) * static_cast<size_t>(rows));
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      height[static_cast<size_t>(y * columns + x)] =
          fractalNoise(key, 1 << 12, 4, static_cast<float>(x) / kWidth, static_cast<float>(y) / kWidth);
    }
  }
  std::vector<float> sorted = height;
  const auto kept = static_cast<std::ptrdiff_t>((1.0 - part) * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), sorted.begin() + kept, sorted.end());
  const float threshold = sorted[static_cast<size_t>(kept)];
  for (int v = 0; v < depth_m.rows; ++v) {
    float* row = depth_m.ptr<float>(v);
    const float* top = height.data() + static_cast<size_t>(v / kStep * columns);
    const float* bottom = top + columns;
    const float fy = static_cast<float>(v % kStep) / kStep;
    for (int u = 0; u < depth_m.cols; ++u) {
      const int x = u / kStep;
      const float fx = static_cast<float>(u % kStep) / kStep;
      const float here =
          (1 - fy) * ((1 - fx) * top[x] + fx * top[x + 1]) + fy * ((1 - fx) * bottom[x] + fx * bottom[x + 1]);
      if (here > threshold) row[u] = 0.0f;
    }
  }
}

void loseEdges(cv::Mat& depth_m) {
  const cv::Mat whole = depth_m.clone();
  const auto jumps = [](float a, float b) {
    return a > 0.0f && b > 0.0f && std::abs(a - b) > 0.03f * std::min(a, b);
  };
  for (int v = 0; v < whole.rows; ++v) {
    const float* row = whole.ptr<float>(v);
    const float* next = whole.ptr<float>(std::min(v + 1, whole.rows - 1));
    for (int u = 0; u < whole.cols; ++u) {
      if (u + 1 < whole.cols && jumps(row[u], row[u + 1])) {
        depth_m.at<float>(v, u) = depth_m.at<float>(v, u + 1) = 0.0f;
      }
      if (jumps(row[u], next[u])) {
        depth_m.at<float>(v, u) = depth_m.at<float>(std::min(v + 1, whole.rows - 1), u) = 0.0f;
      }
    }
  }
}

class SensedSource final : public ObservationSource {
 public:
  SensedSource(std::unique_ptr<ObservationSource> source, const SensorOptions& options, int robot,
               uint64_t seed)
      : source_(std::move(source)),
        options_(options),
        key_(hashCombine(mix64(seed), static_cast<uint64_t>(static_cast<int64_t>(robot)))),
        response_(responseOf(options, Random(key_, kCamera))) {}

  std::optional<Observation> next() override {
    std::optional<Observation> seen = source_->next();
    if (!seen) return seen;
    if (options_.exposure > 0.0 || options_.color_cast > 0.0) {
      cv::Mat changed;
      cv::LUT(seen->color, response_, changed);
      seen->color = changed;
    }
    if (options_.pose_drift > 0.0) drift(*seen);
    if (options_.depth_noise > 0.0 || options_.depth_holes > 0.0) senseDepth(*seen);
    return seen;
  }

  std::optional<int32_t> numObservations() const override { return source_->numObservations(); }
  bool ready() override { return source_->ready(); }
  std::string troubles() const override { return source_->troubles(); }
  Vehicle vehicle() const override { return source_->vehicle(); }

 private:
  Random randomFor(Sensor sensor, const Observation& seen) const {
    return Random(key_, sensor, static_cast<uint64_t>(static_cast<int64_t>(seen.number)));
  }

  void drift(Observation& seen) {
    constexpr double kTurnPerShift = 0.02;  // radians a metre
    const Eigen::Vector3d p = seen.world_from_camera.translation();
    if (previous_) {
      Random random = randomFor(kDrift, seen);
      const double sigma = options_.pose_drift * std::sqrt((p - *previous_).norm());
      const double x = sigma * normal(random), y = sigma * normal(random);
      believed_from_true_ =
          believed_from_true_ * turnAbout(p, 0.5 * kTurnPerShift * sigma * normal(random), x, y);
    }
    previous_ = p;
    seen.world_from_camera = believed_from_true_ * seen.world_from_camera;
  }

  void senseDepth(Observation& seen) const {
    seen.depth_m = seen.depth_m.clone();  // the source may keep its own
    if (options_.depth_holes > 0.0) {
      loseEdges(seen.depth_m);
      Random random = randomFor(kDepthHoles, seen);
      const double part = options_.depth_holes * between(random, 0.5, 1.5);
      losePatches(seen.depth_m, part, random());
    }
    if (options_.depth_noise > 0.0)
      addDepthNoise(seen.depth_m, options_.depth_noise, randomFor(kDepthNoise, seen));
  }

  const std::unique_ptr<ObservationSource> source_;
  const SensorOptions options_;
  const uint64_t key_;
  const cv::Mat response_;
  Pose believed_from_true_ = Pose::Identity();
  std::optional<Eigen::Vector3d> previous_;  // where the camera truly was
};

}  // namespace

void checkSensors(const SensorOptions& options) {
  const auto check = [](const char* name, double value, double most) {
    if (value >= 0.0 && value <= most) return;
    throw std::invalid_argument(std::string(name) + " must lie in [0, " + std::to_string(most) + "], got " +
                                std::to_string(value));
  };
  check("exposure", options.exposure, 9.0);
  check("color_cast", options.color_cast, 0.99);
  check("pose_drift", options.pose_drift, 10.0);
  check("depth_noise", options.depth_noise, 0.3);
  check("depth_holes", options.depth_holes, 0.6);
}

std::unique_ptr<ObservationSource> withSensors(std::unique_ptr<ObservationSource> source,
                                               const SensorOptions& options, int robot, uint64_t seed) {
  SHOAL_DEMAND(source != nullptr);
  checkSensors(options);
  if (options == SensorOptions{}) return source;
  return std::make_unique<SensedSource>(std::move(source), options, robot, seed);
}

}  // namespace shoal::world
