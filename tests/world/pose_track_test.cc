// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/pose_track.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace shoal::world {
namespace {

TimedPose at(int64_t ms, double x, double yaw = 0) {
  return {{ms * 1000}, {x, 0, 0}, Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()))};
}

double yawOf(const Pose& pose) { return std::atan2(pose.linear()(1, 0), pose.linear()(0, 0)); }

TEST(PoseTrackTest, InterpolatesBetweenNeighbours) {
  PoseTrack track;
  track.add(at(400, 4.0, 1.2));
  track.add(at(0, 0.0, 0.4));  // in any order
  const auto pose = track.at({100'000});
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->translation().x(), 1.0, 1e-12);
  EXPECT_NEAR(yawOf(*pose), 0.6, 1e-12);  // a quarter of the way from .4 to 1.2
  EXPECT_NEAR(pose->linear().determinant(), 1.0, 1e-12);
}

TEST(PoseTrackTest, TakesTheShortWayRound) {
  constexpr double kPi = std::numbers::pi;
  PoseTrack track;
  track.add(at(0, 0, kPi - 0.1));
  TimedPose other = at(100, 0, -kPi + 0.1);
  other.orientation.coeffs() *= -1;  // the same rotation, said the other way
  track.add(other);
  EXPECT_NEAR(std::abs(yawOf(*track.at({50'000}))), kPi, 1e-9);
}

TEST(PoseTrackTest, ThePoseSaidForATimeIsTakenAsItIs) {
  PoseTrack track;
  const TimedPose said = at(1000, 0.1 + 0.2, 0.7);
  track.add(at(900, -5));
  track.add(said);
  track.add(at(1100, 5));
  EXPECT_TRUE(track.at(said.time)->isApprox(said.pose(), 0.0));
}

TEST(PoseTrackTest, AcrossAGapOnlyTheNearestWithinTheToleranceCounts) {
  PoseTrack track({.tolerance_us = 20'000, .max_pose_gap_us = 500'000});
  track.add(at(0, 0));
  track.add(at(501, 5.01));
  EXPECT_EQ(track.at({20'000})->translation().x(), 0);
  EXPECT_FALSE(track.at({20'001}));
  EXPECT_FALSE(track.at({250'000}));
  EXPECT_EQ(track.at({481'000})->translation().x(), 5.01);
  track.add(at(500, 5.0));
  EXPECT_NEAR(track.at({250'000})->translation().x(), 2.5, 1e-12);
}

TEST(PoseTrackTest, OutsideOfAllTheNearestWithinTheToleranceCounts) {
  PoseTrack track;
  EXPECT_FALSE(track.at({0}));
  track.add(at(1000, 3));
  EXPECT_TRUE(track.at({980'000}));
  EXPECT_FALSE(track.at({979'999}));
  EXPECT_TRUE(track.at({1'020'000}));
  EXPECT_FALSE(track.at({1'020'001}));
}

TEST(PoseTrackTest, OfTwoAtOneTimeTheFirstStays) {
  PoseTrack track;
  EXPECT_TRUE(track.add(at(5, 1)));
  EXPECT_FALSE(track.add(at(5, 2)));
  EXPECT_EQ(track.at({5000})->translation().x(), 1);
}

TEST(PoseTrackTest, IsSettledOnceALaterPoseCame) {
  PoseTrack track;
  EXPECT_FALSE(track.isSettled({0}));
  track.add(at(10, 0));
  EXPECT_TRUE(track.isSettled({10'000}));
  EXPECT_FALSE(track.isSettled({10'001}));
}

TEST(PoseTrackTest, ForgetsWhatNoLaterTimeNeeds) {
  PoseTrack track;
  for (int i = 0; i < 10; ++i) track.add(at(i * 100, i));
  const auto before = track.at({450'000});
  track.forgetBefore({450'000});
  EXPECT_EQ(track.size(), 6u);  // 400 ms to 900 ms
  EXPECT_TRUE(track.at({450'000})->isApprox(*before, 0.0));
  track.forgetBefore({10'000'000});
  EXPECT_EQ(track.size(), 1u);
}

TEST(TimedPoseTest, KnowsASanePose) {
  EXPECT_TRUE(at(0, 1).isSane());
  TimedPose bad = at(0, 1);
  bad.position.x() = std::nan("");
  EXPECT_FALSE(bad.isSane());
  bad = at(0, 1);
  bad.orientation.coeffs().setZero();
  EXPECT_FALSE(bad.isSane());
  bad.orientation = Eigen::Quaterniond(2, 0, 0, 0);
  EXPECT_FALSE(bad.isSane());
}

}  // namespace
}  // namespace shoal::world
