// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/flat_floor.h"

#include <cmath>

#include <gtest/gtest.h>

namespace shoal::world {
namespace {

constexpr Intrinsics kCamera{64, 48, 50.0, 50.0, 31.5, 23.5};

TEST(FlatFloorTest, StraightDownEveryPixelIsAtTheAltitude) {
  const cv::Mat depth = flatFloorDepth(kCamera, lookingDown({5, 6, 107}, 0.3), 7.0);
  ASSERT_EQ(depth.size(), cv::Size(64, 48));
  for (int v = 0; v < 48; ++v)
    for (int u = 0; u < 64; ++u) EXPECT_NEAR(depth.at<float>(v, u), 7.0, 1e-5);
}

// However the camera is tilted, what it sees lies on the plane, and what looks up sees nothing.
TEST(FlatFloorTest, TiltedEveryPointLiesOnTheFloor) {
  for (const double tilt : {0.2, 0.7, 1.2, 1.57, 2.5}) {
    Pose pose = lookingDown({-3, 4, 10});
    pose.linear() = pose.linear() * Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()).toRotationMatrix();
    const cv::Mat depth = flatFloorDepth(kCamera, pose, 2.5);
    for (int v = 0; v < 48; ++v) {
      for (int u = 0; u < 64; ++u) {
        const double metres = depth.at<float>(v, u);
        const Eigen::Vector3d ray = pose.linear() * kCamera.unproject(u, v, 1.0);
        if (ray.z() > -0.1) {
          EXPECT_EQ(metres, 0.0) << "at or above the horizon, or farther than ten altitudes";
        } else {
          EXPECT_NEAR((pose * kCamera.unproject(u, v, metres)).z(), 7.5, 1e-4);
          EXPECT_LE(metres, 25.0001);
        }
      }
    }
  }
}

}  // namespace
}  // namespace shoal::world
