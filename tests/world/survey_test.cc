// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/survey.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "shoal/world/ortho_world.h"

namespace shoal::world {
namespace {

const Intrinsics kCamera;  // sees 12.8 m x 9.6 m from 8 m
constexpr double kAltitude = 8.0;

OrthoWorld meadow(int width, int height, double metres_per_pixel) {
  return OrthoWorld("meadow", cv::Mat(height, width, CV_8UC3, cv::Scalar(1, 2, 3)), {}, metres_per_pixel, {});
}

TEST(LawnmowerTest, LooksDownFromTheAltitudeAsOftenAsAsked) {
  for (int32_t n : {1, 2, 3, 7, 12, 60, 61, 250}) {
    const std::vector<Pose> path = lawnmower({0, -80, 60, 0}, n, kAltitude, kCamera);
    ASSERT_EQ(path.size(), static_cast<size_t>(n));
    for (const Pose& pose : path) {
      EXPECT_EQ(pose.translation().z(), kAltitude);
      EXPECT_TRUE(pose.linear().isApprox(lookingDown({0, 0, 0}).linear()));
    }
  }
}

// 20 m x 24 m under footprints of 12.8 m x 9.6 m: 2 x 3 frames cover it, flush with the edges, up one leg and
// down the next.
//
//     0  5
//     1  4
//     2  3
TEST(LawnmowerTest, FliesLegsThereAndBackUpToTheEdges) {
  const std::vector<Pose> path = lawnmower({100, -24, 120, 0}, 6, kAltitude, kCamera);
  const double west = 106.4, east = 113.6, north = -4.8, middle = -12.0, south = -19.2;
  const std::vector<std::pair<double, double>> expected{{west, north}, {west, middle}, {west, south},
                                                        {east, south}, {east, middle}, {east, north}};
  ASSERT_EQ(path.size(), expected.size());
  for (size_t i = 0; i < path.size(); ++i) {
    EXPECT_NEAR(path[i].translation().x(), expected[i].first, 1e-9) << i;
    EXPECT_NEAR(path[i].translation().y(), expected[i].second, 1e-9) << i;
  }
  EXPECT_EQ(coverage({100, -24, 120, 0}, path, kCamera), 1.0);
}

TEST(LawnmowerTest, StaysOverTheMiddleOfAShareThatOneFrameCovers) {
  for (const Pose& pose : lawnmower({0, -6, 10, 0}, 5, kAltitude, kCamera)) {
    EXPECT_NEAR(pose.translation().x(), 5, 1e-9);
    EXPECT_NEAR(pose.translation().y(), -3, 1e-9);
  }
}

TEST(LawnmowerTest, ReachesTheEdgesWithAPrincipalPointOffCentre) {
  Intrinsics camera;
  camera.cx = 40;
  camera.cy = 200;
  EXPECT_EQ(coverage({0, -24, 20, 0}, lawnmower({0, -24, 20, 0}, 6, kAltitude, camera), camera), 1.0);
}

// Whenever a grid of footprints with that many frames covers a share, so does the path.
TEST(LawnmowerTest, CoversWheneverFramesSuffice) {
  for (const auto& [w, h] : {std::pair{62.5, 83.3}, {83.3, 62.5}, {30.0, 120.0}, {12.0, 50.0}, {50.0, 9.0}}) {
    const double needed = std::ceil(w / 12.8) * std::ceil(h / 9.6);
    for (const int extra : {0, 1, 2, 5, 13, 50}) {
      const Extent share{10, -h - 3, 10 + w, -3};
      const auto path = lawnmower(share, static_cast<int32_t>(needed) + extra, kAltitude, kCamera);
      EXPECT_GE(coverage(share, path, kCamera), 0.95) << w << " x " << h << " with " << needed + extra;
    }
  }
}

// Fewer frames than that must not overlap: they see as much as they can, within a sample's width.
TEST(LawnmowerTest, WastesNothingWhenFramesDoNotSuffice) {
  const Extent share{0, -250, 250, 0};
  constexpr double kSample = 250.0 / 300;
  for (const int32_t n : {1, 4, 9, 16, 25, 100}) {
    const double seen = coverage(share, lawnmower(share, n, kAltitude, kCamera), kCamera);
    EXPECT_NEAR(seen, n * 12.8 * 9.6 / 62500, kSample * (12.8 + 9.6 + kSample) * n / 62500) << n;
  }
}

TEST(LawnmowerTest, RefusesWhatCannotBeFlown) {
  const Extent share{0, -10, 10, 0};
  EXPECT_THROW(lawnmower(share, 0, 8, kCamera), std::invalid_argument);
  EXPECT_THROW(lawnmower(share, 5, 0, kCamera), std::invalid_argument);
  EXPECT_THROW(lawnmower(share, 5, std::nan(""), kCamera), std::invalid_argument);
  EXPECT_THROW(lawnmower(share, 5, 8, {320, 240, -1}), std::invalid_argument);
}

// By hand: one footprint of 12.8 m x 9.6 m, of a share of 25.6 m x 19.2 m; then a second that overlaps half.
TEST(CoverageTest, IsThePartThatAtLeastOneFootprintCovers) {
  const Extent share{0, -19.2, 25.6, 0};
  std::vector<Pose> path{lookingDown({6.4, -4.8, 8})};
  EXPECT_NEAR(coverage(share, path, kCamera), 0.25, 0.005);
  path.push_back(lookingDown({12.8, -4.8, 8}));
  EXPECT_NEAR(coverage(share, path, kCamera), 0.375, 0.005);
  path.push_back(lookingDown({-50, 0, 8}));
  EXPECT_NEAR(coverage(share, path, kCamera), 0.375, 0.005);
  EXPECT_EQ(coverage(share, {}, kCamera), 0.0);
}

// A quarter turn swaps the footprint's sides; a camera that looks up sees no ground.
TEST(CoverageTest, KnowsWhereACameraLooks) {
  const Extent share{-12.8, -12.8, 12.8, 12.8};
  const auto seen = [&](const Pose& pose) { return coverage({-4.8, -6.4, 4.8, 6.4}, {pose}, kCamera); };
  EXPECT_NEAR(seen(lookingDown({0, 0, 8}, std::acos(0.0))), 1.0, 0.005);
  EXPECT_NEAR(seen(lookingDown({0, 0, 8})), 0.75, 0.005);
  Pose up = Pose::Identity();
  up.translation().z() = 8;
  EXPECT_EQ(coverage(share, {up}, kCamera), 0.0);
}

TEST(SurveyPathTest, FliesAtNativeResolutionUnlessTold) {
  const OrthoWorld world = meadow(800, 600, 0.5);
  SurveyOptions options;
  options.observations = 4;
  EXPECT_DOUBLE_EQ(surveyPath(world, options, 0)[0].translation().z(), 100.0);  // 200 px x 0.5 m
  options.intrinsics.fx = 300;
  EXPECT_DOUBLE_EQ(surveyPath(world, options, 0)[0].translation().z(), 150.0);
  options.altitude_m = 33;
  EXPECT_DOUBLE_EQ(surveyPath(world, options, 0)[0].translation().z(), 33.0);
}

TEST(SurveyPathTest, CoversWithThirtyPercentOverlapWhenObservationsAreUnlimited) {
  const OrthoWorld world = meadow(2500, 2500, 0.1);
  SurveyOptions options;
  options.num_robots = 12;
  const Grid grid(world.defaultCellSize());
  const std::vector<Extent> team = shares(world.extent(), 12, grid);
  for (int robot = 0; robot < 12; ++robot) {
    const std::vector<Pose> path = surveyPath(world, options, robot);
    EXPECT_EQ(coverage(team[static_cast<size_t>(robot)], path, options.intrinsics), 1.0) << robot;
    // Footprints of 32 m x 24 m that advance by at most 70 % over about 62.5 m x 83.3 m: 3 x 5.
    EXPECT_EQ(path.size(), 15u) << robot;
  }
}

// Footprints of 32 m x 24 m over 100 m x 24 m: five advance by 17 m, four would by 22.7 m, more than 70 %.
TEST(SurveyPathTest, AdvancesByAtMostSeventyPercentOfAFrame) {
  EXPECT_EQ(surveyPath(meadow(1000, 240, 0.1), {}, 0).size(), 5u);
}

TEST(SurveyPathTest, StringsTheTeamTogetherForASingleRobot) {
  const OrthoWorld world = meadow(1000, 800, 0.2);
  SurveyOptions options;
  options.num_robots = 5;
  options.observations = 7;
  std::vector<Pose> expected;
  for (int robot = 0; robot < 5; ++robot) {
    for (const Pose& pose : surveyPath(world, options, robot)) expected.push_back(pose);
  }
  const std::vector<Pose> single = surveyPath(world, options, 0, true);
  ASSERT_EQ(single.size(), 35u);
  for (size_t i = 0; i < single.size(); ++i) EXPECT_EQ(single[i].matrix(), expected[i].matrix()) << i;
}

TEST(SurveyPathTest, RefusesWhatMakesNoSurvey) {
  const OrthoWorld world = meadow(100, 100, 1.0);
  const auto with = [&](auto change) {
    SurveyOptions options;
    options.num_robots = 2;
    change(options);
    return options;
  };
  EXPECT_THROW(surveyPath(world, with([](auto&) {}), 2), std::invalid_argument);
  EXPECT_THROW(surveyPath(world, with([](auto&) {}), -1), std::invalid_argument);
  EXPECT_THROW(surveyPath(world, with([](auto& o) { o.num_robots = 0; }), 0), std::invalid_argument);
  EXPECT_THROW(surveyPath(world, with([](auto& o) { o.num_robots = 0; }), 0, true), std::invalid_argument);
  EXPECT_THROW(surveyPath(world, with([](auto& o) { o.observations = -1; }), 0), std::invalid_argument);
  EXPECT_THROW(surveyPath(world, with([](auto& o) { o.altitude_m = -1; }), 0), std::invalid_argument);
  EXPECT_THROW(surveyPath(world, with([](auto& o) { o.cell_size_m = -1; }), 0), std::invalid_argument);
  EXPECT_THROW(surveyPath(world, with([](auto& o) { o.intrinsics.width = 0; }), 0), std::invalid_argument);
}

TEST(SurveySourceTest, RendersThePathFrameByFrame) {
  const OrthoWorld world = meadow(400, 300, 0.1);
  const std::vector<Pose> path{lookingDown({5, -5, 20}), lookingDown({6, -5, 20}),
                               lookingDown({7, -5, 20}, 1)};
  const auto source = makeSurveySource(world, path, kCamera, 0.25);
  EXPECT_EQ(source->numObservations(), 3);
  for (int i = 0; i < 3; ++i) {
    const auto seen = source->next();
    ASSERT_TRUE(seen.has_value());
    EXPECT_EQ(seen->number, i);
    EXPECT_EQ(seen->time.us, 250000 * i);
    EXPECT_EQ(seen->world_from_camera.matrix(), path[static_cast<size_t>(i)].matrix());
    const Observation expected = world.render(kCamera, path[static_cast<size_t>(i)]);
    EXPECT_EQ(cv::norm(seen->color, expected.color, cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(seen->depth_m, expected.depth_m, cv::NORM_INF), 0);
  }
  EXPECT_FALSE(source->next().has_value());
  EXPECT_FALSE(source->next().has_value());
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(makeSurveySource(world, path, kCamera, bad), std::invalid_argument);
  }
}

}  // namespace
}  // namespace shoal::world
