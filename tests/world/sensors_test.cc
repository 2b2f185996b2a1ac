// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/sensors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace shoal::world {
namespace {

constexpr int kSensorWidth = 64, kSensorHeight = 48;

/// A camera that flies east, a metre a frame, over grey ground 8 m below with a step of 1 m in the middle.
class Flight final : public ObservationSource {
 public:
  explicit Flight(int32_t frames, int32_t first = 0) : frames_(frames), next_(first) {}

  static Observation frame(int32_t number) {
    Observation seen;
    seen.number = number;
    seen.color = cv::Mat(kSensorHeight, kSensorWidth, CV_8UC3, cv::Scalar(100, 120, 60));
    seen.depth_m = cv::Mat(kSensorHeight, kSensorWidth, CV_32FC1, cv::Scalar(8));
    seen.depth_m.colRange(kSensorWidth / 2, kSensorWidth) = 7;
    seen.depth_m.at<float>(0, 0) = 0;
    seen.labels = cv::Mat(kSensorHeight, kSensorWidth, CV_8UC1, cv::Scalar(3));
    seen.intrinsics = {kSensorWidth, kSensorHeight, 50, 50, 31.5, 23.5};
    seen.world_from_camera = lookingDown({static_cast<double>(number), 0, 8});
    return seen;
  }

  std::optional<Observation> next() override {
    if (next_ >= frames_) return std::nullopt;
    return frame(next_++);
  }
  std::optional<int32_t> numObservations() const override { return frames_; }
  bool ready() override { return next_ < 2; }
  std::string troubles() const override { return "fog"; }

 private:
  int32_t frames_, next_;
};

std::vector<Observation> fly(const SensorOptions& options, int robot, uint64_t seed, int32_t frames,
                             int32_t first = 0) {
  const auto source = withSensors(std::make_unique<Flight>(frames, first), options, robot, seed);
  std::vector<Observation> all;
  while (auto seen = source->next()) all.push_back(std::move(*seen));
  return all;
}

bool same(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0.0; }

bool same(const Observation& a, const Observation& b) {
  return a.number == b.number && same(a.color, b.color) && same(a.depth_m, b.depth_m) &&
         same(a.labels, b.labels) && a.world_from_camera.matrix() == b.world_from_camera.matrix();
}

const SensorOptions kAll{.42, .12, .05, .02, .1};

TEST(SensorsTest, PerfectOnesGiveTheSourceBack) {
  auto source = std::make_unique<Flight>(3);
  const ObservationSource* before = source.get();
  EXPECT_EQ(withSensors(std::move(source), {}, 2, 5).get(), before);
}

TEST(SensorsTest, KeepNumbersLabelsAndWhatTheSourceSaysOfItself) {
  const auto source = withSensors(std::make_unique<Flight>(4), kAll, 1, 7);
  EXPECT_EQ(source->numObservations(), 4);
  for (int32_t n = 0; n < 4; ++n) {
    EXPECT_EQ(source->ready(), n < 2);
    const auto seen = source->next();
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->number, n);
    EXPECT_TRUE(same(seen->labels, Flight::frame(n).labels));
  }
  EXPECT_FALSE(source->next());
  EXPECT_EQ(source->troubles(), "fog");
}

TEST(SensorsTest, RepeatWithTheSeedAndDifferWithTheRobotAndTheSeed) {
  const auto a = fly(kAll, 1, 7, 6), again = fly(kAll, 1, 7, 6), robot = fly(kAll, 2, 7, 6),
             seed = fly(kAll, 1, 8, 6);
  for (size_t n = 1; n < a.size(); ++n) {
    EXPECT_TRUE(same(a[n], again[n]));
    for (const auto& other : {robot[n], seed[n]}) {
      EXPECT_FALSE(same(a[n].color, other.color));
      EXPECT_FALSE(same(a[n].depth_m, other.depth_m));
      EXPECT_FALSE(a[n].world_from_camera.isApprox(other.world_from_camera, 1e-6));
    }
  }
}

// A robot that joins late, or a reader that skips, sees the same pictures and depths.
TEST(SensorsTest, DependOnTheNumberOfTheObservationNotOnHowManyCameBefore) {
  const auto all = fly(kAll, 1, 7, 6), late = fly(kAll, 1, 7, 6, 4);
  EXPECT_TRUE(same(all[4].color, late[0].color));
  EXPECT_TRUE(same(all[4].depth_m, late[0].depth_m));
  EXPECT_FALSE(same(all[4].depth_m, all[5].depth_m));
}

TEST(SensorsTest, GiveEachRobotOneBrightnessLogUniformInItsRange) {
  int brighter = 0;
  double lowest = 9, highest = 0;
  constexpr int kRobots = 400;
  for (int robot = 0; robot < kRobots; ++robot) {
    const auto seen = fly({.exposure = .42}, robot, 3, 2);
    EXPECT_TRUE(same(seen[0].color, seen[1].color));
    const cv::Vec3b c = seen[0].color.at<cv::Vec3b>(5, 5);
    const double factor = c[1] / 120.0;
    EXPECT_NEAR(c[0] / 100.0, factor, .012);  // alike in every channel, to half a grey level of each
    EXPECT_NEAR(c[2] / 60.0, factor, .014);
    brighter += factor > 1.0;
    lowest = std::min(lowest, factor);
    highest = std::max(highest, factor);
  }
  EXPECT_NEAR(brighter, kRobots / 2, 40);  // four standard deviations
  EXPECT_GE(lowest, 1 / 1.42 - .005);
  EXPECT_LT(lowest, 1 / 1.42 + .02);
  EXPECT_LE(highest, 1.42 + .005);
  EXPECT_GT(highest, 1.42 - .02);
}

TEST(SensorsTest, CastEachChannelByItself) {
  double lowest[3] = {9, 9, 9}, highest[3] = {0, 0, 0};
  bool apart = false;
  for (int robot = 0; robot < 300; ++robot) {
    const cv::Vec3b c = fly({.color_cast = .12}, robot, 3, 1)[0].color.at<cv::Vec3b>(5, 5);
    const double was[3] = {100, 120, 60};
    for (int i = 0; i < 3; ++i) {
      lowest[i] = std::min(lowest[i], c[i] / was[i]);
      highest[i] = std::max(highest[i], c[i] / was[i]);
    }
    apart |= c[0] / was[0] > 1.05 && c[1] / was[1] < .95;
  }
  EXPECT_TRUE(apart);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(lowest[i], .88, .012) << i;
    EXPECT_NEAR(highest[i], 1.12, .012) << i;
  }
}

TEST(SensorsTest, ClipWhatIsBrighterThanWhite) {
  bool clipped = false;
  for (int robot = 0; robot < 20; ++robot) {
    const cv::Vec3b c = fly({.exposure = 9}, robot, 3, 1)[0].color.at<cv::Vec3b>(5, 5);
    clipped |= c[1] == 255;
    EXPECT_GE(c[1], c[2]);  // never wraps round
  }
  EXPECT_TRUE(clipped);
}

// 200 robots, 100 m each: x and y err by .05 sqrt(100) m = .5 m and what the heading adds on the way,
// heading by .02 x .05 x sqrt(100) = .01 rad.
TEST(SensorsTest, DriftAsTheSquareRootOfTheWayFlown) {
  double along = 0, heading = 0, quarter = 0, first = 0, height = 0;
  constexpr int kRobots = 200;
  for (int robot = 0; robot < kRobots; ++robot) {
    const auto seen = fly({.pose_drift = .05}, robot, 3, 101);
    const auto error = [&](size_t n) -> Eigen::Vector3d {
      return seen[n].world_from_camera.translation() - Eigen::Vector3d(static_cast<double>(n), 0, 8);
    };
    first = std::max(first, error(0).norm());
    height = std::max(height, std::abs(error(100).z()));
    along += error(100).x() * error(100).x() / kRobots;
    quarter += error(25).x() * error(25).x() / kRobots;
    const Eigen::Matrix3d turned = seen[100].world_from_camera.linear();
    ASSERT_LT((turned * turned.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-9);
    const double yaw = std::atan2(turned(1, 0), turned(0, 0));
    heading += yaw * yaw / kRobots;
  }
  EXPECT_EQ(first, 0);
  EXPECT_LT(height, 1e-9);
  EXPECT_NEAR(std::sqrt(along), .5, .1);  // 5 % is one standard deviation of this estimate
  EXPECT_NEAR(std::sqrt(quarter), .25, .05);
  EXPECT_NEAR(std::sqrt(heading), .01, .002);
}

TEST(SensorsTest, MakeDepthNoisierTheFurtherItIs) {
  const cv::Mat depth_m = fly({.depth_noise = .02}, 1, 3, 1)[0].depth_m;
  EXPECT_EQ(depth_m.at<float>(0, 0), 0);  // none stays none
  cv::Scalar mean, deviation;
  cv::meanStdDev(depth_m(cv::Rect(1, 1, kSensorWidth / 2 - 1, kSensorHeight - 1)), mean, deviation);
  EXPECT_NEAR(mean[0], 8, .02);
  EXPECT_NEAR(deviation[0], .16, .015);
  cv::meanStdDev(depth_m.colRange(kSensorWidth / 2, kSensorWidth), mean, deviation);
  EXPECT_NEAR(mean[0], 7, .02);
  EXPECT_NEAR(deviation[0], .14, .015);
}

TEST(SensorsTest, LoseDepthInPatchesAndAtJumps) {
  double lost = 0;
  int borders = 0;  // between missing and present: few when patches are patches
  const auto seen = fly({.depth_holes = .2}, 1, 3, 60);
  for (const Observation& frame : seen) {
    for (int v = 1; v < kSensorHeight; ++v) {
      EXPECT_EQ(frame.depth_m.at<float>(v, kSensorWidth / 2 - 1), 0);
      EXPECT_EQ(frame.depth_m.at<float>(v, kSensorWidth / 2), 0);
      for (int u = 1; u < kSensorWidth / 2 - 1; ++u) {
        const float d = frame.depth_m.at<float>(v, u);
        EXPECT_TRUE(d == 0 || d == 8) << d;
        lost += d == 0;
        borders += (d == 0) != (frame.depth_m.at<float>(v, u + 1) == 0) && u + 2 < kSensorWidth / 2;
      }
    }
  }
  const double pixels = 60.0 * (kSensorHeight - 1) * (kSensorWidth / 2 - 2);
  EXPECT_NEAR(lost / pixels, .2, .06);
  EXPECT_LT(borders / pixels, .06);  // at random there would be 2 x .2 x .8
}

TEST(SensorsTest, LeaveTheSourcesOwnPicturesAlone) {
  class Kept final : public ObservationSource {
   public:
    explicit Kept(const Observation& frame) : frame_(frame) {}
    std::optional<Observation> next() override { return frame_; }
    std::optional<int32_t> numObservations() const override { return std::nullopt; }

   private:
    const Observation& frame_;
  };
  const Observation frame = Flight::frame(0);
  const auto source = withSensors(std::make_unique<Kept>(frame), kAll, 1, 3);
  EXPECT_FALSE(source->numObservations());
  const auto seen = source->next();
  EXPECT_FALSE(same(*seen, frame));
  EXPECT_TRUE(same(frame, Flight::frame(0)));
}

TEST(SensorsTest, NameTheOptionThatIsOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::pair<const char*, double SensorOptions::*> fields[] = {
      {"exposure", &SensorOptions::exposure},       {"color_cast", &SensorOptions::color_cast},
      {"pose_drift", &SensorOptions::pose_drift},   {"depth_noise", &SensorOptions::depth_noise},
      {"depth_holes", &SensorOptions::depth_holes},
  };
  for (const auto& [name, field] : fields) {
    for (const double bad : {-.1, 11., nan}) {
      SensorOptions options;
      options.*field = bad;
      try {
        withSensors(std::make_unique<Flight>(1), options, 0, 1);
        ADD_FAILURE() << name << ' ' << bad;
      } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
      }
    }
  }
}

}  // namespace
}  // namespace shoal::world
