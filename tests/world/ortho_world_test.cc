// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/ortho_world.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "shoal/random.h"

namespace shoal::world {
namespace {

const std::vector<TruthClass> kClasses{{0, "sand", {}}, {1, "rock", {}}, {2, "coral", {}}, {7, "weed", {}}};

/// Colour tells the pixel: blue = x, green = y, both linear, so that bilinear sampling is exact.
cv::Mat ramp(int width, int height) {
  cv::Mat color(height, width, CV_8UC3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      color.at<cv::Vec3b>(y, x) = {static_cast<uint8_t>(x), static_cast<uint8_t>(y), 200};
    }
  }
  return color;
}

cv::Mat randomLabels(int width, int height) {
  cv::Mat labels(height, width, CV_8UC1);
  Random random(5);
  constexpr uint8_t kIds[] = {0, 1, 2, 7, 255};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) labels.at<uint8_t>(y, x) = kIds[random.below(5)];
  }
  return labels;
}

OrthoWorld makeWorld(int width, int height, double metres_per_pixel) {
  return OrthoWorld("w", ramp(width, height), randomLabels(width, height), metres_per_pixel, kClasses);
}

TEST(OrthoWorldTest, BeginsHalfAPixelOutsideTheFirstCentre) {
  const OrthoWorld world = makeWorld(60, 40, 0.5);
  EXPECT_DOUBLE_EQ(world.extent().min_x, -0.25);
  EXPECT_DOUBLE_EQ(world.extent().max_x, 29.75);
  EXPECT_DOUBLE_EQ(world.extent().min_y, -19.75);
  EXPECT_DOUBLE_EQ(world.extent().max_y, 0.25);
  EXPECT_DOUBLE_EQ(world.defaultCellSize(), 12.0);
}

// Straight down from fx x metres per pixel, a picture pixel fills an image pixel.
TEST(OrthoWorldTest, ShowsItsOwnPixelsAtNativeResolution) {
  const OrthoWorld world = makeWorld(120, 90, 0.5);
  const Intrinsics camera{21, 15, 100, 100, 10, 7};
  const int px = 50, py = 40;
  const Observation seen = world.render(camera, lookingDown({px * 0.5, -py * 0.5, 50.0}));
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const int x = px + u - 10, y = py + v - 7;
      ASSERT_EQ(seen.color.at<cv::Vec3b>(v, u),
                cv::Vec3b(static_cast<uint8_t>(x), static_cast<uint8_t>(y), 200));
      ASSERT_EQ(seen.labels.at<uint8_t>(v, u), randomLabels(120, 90).at<uint8_t>(y, x));
      ASSERT_EQ(seen.depth_m.at<float>(v, u), 50.0f);
    }
  }
}

// A quarter turn counter-clockwise: image up is west, so image right is north.
TEST(OrthoWorldTest, TurnsTheImageWithTheYaw) {
  const OrthoWorld world = makeWorld(120, 90, 1.0);
  const Intrinsics camera{21, 15, 100, 100, 10, 7};
  const Observation seen = world.render(camera, lookingDown({50, -40, 100}, std::numbers::pi / 2));
  EXPECT_EQ(seen.color.at<cv::Vec3b>(7, 10), cv::Vec3b(50, 40, 200));
  EXPECT_EQ(seen.color.at<cv::Vec3b>(7, 15), cv::Vec3b(50, 35, 200));
  EXPECT_EQ(seen.color.at<cv::Vec3b>(4, 10), cv::Vec3b(47, 40, 200));
}

TEST(OrthoWorldTest, HasNoDepthAndNoLabelBesideThePicture) {
  const OrthoWorld world = makeWorld(30, 20, 1.0);
  const Intrinsics camera{9, 9, 10, 10, 4, 4};
  const Observation seen = world.render(camera, lookingDown({0, 0, 10}));  // pixel (0, 0) in the middle
  for (int v = 0; v < 9; ++v) {
    for (int u = 0; u < 9; ++u) {
      const bool inside = u >= 4 && v >= 4;
      EXPECT_EQ(seen.depth_m.at<float>(v, u), inside ? 10.0f : 0.0f);
      EXPECT_EQ(seen.color.at<cv::Vec3b>(v, u)[2], inside ? 200 : 0);
      if (!inside) {
        EXPECT_EQ(seen.labels.at<uint8_t>(v, u), 255);
      }
    }
  }
}

// Against Eigen's own intersection of a line with the plane Z = 0, from tilted and turned poses, some of
// which see the horizon.
TEST(OrthoWorldTest, AgreesWithLinesThatMeetThePlane) {
  const OrthoWorld world = makeWorld(200, 150, 0.5);
  const cv::Mat labels = randomLabels(200, 150);
  const Intrinsics camera{64, 48, 40, 45, 30.5, 25};
  const Eigen::Hyperplane<double, 3> ground(Eigen::Vector3d::UnitZ(), 0.0);
  Random random(11);
  int seen_pixels = 0, empty_pixels = 0;
  for (int trial = 0; trial < 20; ++trial) {
    Pose pose = lookingDown({100 * random.uniform(), -75 * random.uniform(), 10 + 30 * random.uniform()},
                            6.28 * random.uniform());
    pose.linear() = pose.linear() * Eigen::AngleAxisd(1.4 * random.uniform(), Eigen::Vector3d::UnitX()) *
                    Eigen::AngleAxisd(0.5 * random.uniform(), Eigen::Vector3d::UnitY()).toRotationMatrix();
    const Observation seen = world.render(camera, pose);
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        const Eigen::Vector3d through = pose * camera.unproject(u, v, 1.0);
        const auto line = Eigen::ParametrizedLine<double, 3>::Through(pose.translation(), through);
        const double along = line.intersectionParameter(ground);
        const Eigen::Vector3d hit = line.pointAt(along);
        const double x = hit.x() / 0.5, y = -hit.y() / 0.5;
        const double to_border = std::min({x + 0.5, 199.5 - x, y + 0.5, 149.5 - y});
        if (std::abs(to_border) < 1e-6) continue;  // either is right
        const bool visible = along > 0.0 && to_border > 0.0;
        const float depth = seen.depth_m.at<float>(v, u);
        ASSERT_EQ(depth > 0.0f, visible) << trial << ": " << u << ' ' << v;
        ++(visible ? seen_pixels : empty_pixels);
        if (!visible) {
          ASSERT_EQ(seen.color.at<cv::Vec3b>(v, u), cv::Vec3b(0, 0, 0));
          ASSERT_EQ(seen.labels.at<uint8_t>(v, u), 255);
          continue;
        }
        const double expected_depth = (pose.inverse() * hit).z();
        ASSERT_NEAR(depth, expected_depth, 1e-6 * expected_depth);
        const cv::Vec3b color = seen.color.at<cv::Vec3b>(v, u);
        ASSERT_NEAR(color[0], std::clamp(x, 0.0, 199.0), 0.51);  // 1/2 of rounding, 1/256 of weights
        ASSERT_NEAR(color[1], std::clamp(y, 0.0, 149.0), 0.51);
        const bool tie = std::abs(x - std::floor(x) - 0.5) < 1e-6 || std::abs(y - std::floor(y) - 0.5) < 1e-6;
        if (!tie) {
          ASSERT_EQ(seen.labels.at<uint8_t>(v, u),
                    labels.at<uint8_t>(static_cast<int>(std::lround(y)), static_cast<int>(std::lround(x))));
        }
      }
    }
  }
  EXPECT_GT(seen_pixels, 5000);
  EXPECT_GT(empty_pixels, 5000);
}

TEST(OrthoWorldTest, ShowsNothingToACameraThatLooksUpOrStandsBelow) {
  const OrthoWorld world = makeWorld(30, 20, 1.0);
  const Intrinsics camera{8, 8, 10, 10, 3.5, 3.5};
  Pose up = Pose::Identity();
  up.translation() = Eigen::Vector3d(10, -10, 5);
  EXPECT_EQ(cv::countNonZero(world.render(camera, up).depth_m), 0);
  EXPECT_EQ(cv::countNonZero(world.render(camera, lookingDown({10, -10, -5})).depth_m), 0);
}

TEST(OrthoWorldTest, ShowsTheSameFromTheSamePose) {
  const OrthoWorld world = makeWorld(120, 90, 0.5);
  const Pose pose = lookingDown({20.1, -17.3, 21.0}, 0.3);
  const Observation a = world.render({}, pose), b = world.render({}, pose);
  EXPECT_EQ(cv::norm(a.color, b.color, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(a.labels, b.labels, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(a.depth_m, b.depth_m, cv::NORM_INF), 0);
}

TEST(OrthoWorldTest, SeesAPictureOfASinglePixel) {
  const OrthoWorld world("w", ramp(1, 1), cv::Mat(1, 1, CV_8UC1, cv::Scalar(7)), 1.0, kClasses);
  const Observation seen = world.render({3, 3, 10, 10, 1, 1}, lookingDown({0, 0, 10}));
  EXPECT_EQ(cv::countNonZero(seen.depth_m), 1);
  EXPECT_EQ(seen.labels.at<uint8_t>(1, 1), 7);
}

TEST(OrthoWorldTest, NeedsNoLabels) {
  const OrthoWorld world("w", ramp(30, 20), {}, 1.0, {});
  EXPECT_FALSE(world.hasFlatTruth());
  EXPECT_EQ(world.truthOfSquare(Grid(4), {1, -1, 0}), std::nullopt);
  EXPECT_TRUE(world.render({}, lookingDown({10, -10, 5})).labels.empty());
}

TEST(OrthoWorldTest, RefusesWhatIsNoWorld) {
  const cv::Mat color = ramp(4, 3), labels(3, 4, CV_8UC1, cv::Scalar(1));
  EXPECT_THROW(OrthoWorld("w", {}, {}, 1.0, {}), std::invalid_argument);
  EXPECT_THROW(OrthoWorld("w", labels, {}, 1.0, {}), std::invalid_argument);
  EXPECT_THROW(OrthoWorld("w", color, cv::Mat(4, 3, CV_8UC1), 1.0, kClasses), std::invalid_argument);
  EXPECT_THROW(OrthoWorld("w", color, color, 1.0, kClasses), std::invalid_argument);
  EXPECT_THROW(OrthoWorld("w", color, labels, 1.0, {{0, "only sand", {}}}), std::invalid_argument);
  EXPECT_THROW(OrthoWorld("w", color, labels, 1.0, {{1, "a", {}}, {1, "b", {}}}), std::invalid_argument);
  EXPECT_THROW(OrthoWorld("w", color, labels, 1.0, {{1, "a", {}}, {255, "b", {}}}), std::invalid_argument);
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(OrthoWorld("w", color, labels, bad, kClasses), std::invalid_argument);
  }
}

TEST(OrthoWorldTest, RefusesACameraThatIsNone) {
  const OrthoWorld world = makeWorld(30, 20, 1.0);
  const Pose pose = lookingDown({5, -5, 5});
  EXPECT_THROW((void)world.render({0, 240}, pose), std::invalid_argument);
  EXPECT_THROW((void)world.render({320, 100000}, pose), std::invalid_argument);
  EXPECT_THROW((void)world.render({320, 240, 0.0}, pose), std::invalid_argument);
  EXPECT_THROW((void)world.render({320, 240, 200, std::nan("")}, pose), std::invalid_argument);
  EXPECT_THROW((void)world.render({320, 240, 200, 200, std::nan("")}, pose), std::invalid_argument);
  EXPECT_THROW((void)world.render({}, lookingDown({5, std::nan(""), 5})), std::invalid_argument);
}

}  // namespace
}  // namespace shoal::world
