// SPDX-License-Identifier: BSD-3-Clause
// The evaluation worlds, and the reefs, under the default survey. SHOAL_DATA names the worlds' folder.
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "shoal/world/place.h"

namespace shoal::world {
namespace {

std::string given(const std::string& name) { return std::string(std::getenv("SHOAL_DATA")) + "/" + name; }

TEST(GivenWorldsTest, AreCoveredByTwelveRobotsWithSixtyObservations) {
  for (const std::string& spec :
       {given("dubai_tile5"), given("seabed_varied_a"), std::string("reef:sparse")}) {
    const auto world = openWorld(spec);
    SurveyOptions options;
    options.num_robots = 12;
    options.observations = 60;
    const std::vector<Extent> team = shares(world->extent(), 12, Grid(world->defaultCellSize()));
    for (int robot = 0; robot < 12; ++robot) {
      EXPECT_GE(
          coverage(team[static_cast<size_t>(robot)], surveyPath(*world, options, robot), options.intrinsics),
          0.95)
          << spec << ' ' << robot;
    }
  }
}

// Nearly everything is labelled.
TEST(GivenWorldsTest, HaveTruthForTheirCells) {
  const auto world = openWorld(given("dubai_tile5"));
  EXPECT_EQ(world->name(), "dubai_tile5");
  EXPECT_EQ(world->classes().size(), 5u);
  const Grid grid(world->defaultCellSize());
  int cells = 0, scored = 0;
  for (int32_t i = 0; i <= 140; ++i) {
    for (int32_t j = -132; j <= 0; ++j) {
      ++cells;
      scored += *world->truthOfSquare(grid, {i, j, 0}) != 255;
    }
  }
  EXPECT_GT(scored, cells * 9 / 10);
}

TEST(GivenWorldsTest, RecordingsFlyWithEveryFrame) {
  const auto team = openPlace(given("uav_dubai_tile5"));
  EXPECT_EQ(team->maxRobots(), 4);
  EXPECT_EQ(team->classes().size(), 5u);
  SurveyOptions options = team->completed({});
  EXPECT_EQ(options.observations, 30);
  EXPECT_NEAR(options.cell_size_m, 24.0, 2.0);  // about 200 m above ground, fx 200
  options.num_robots = 4;
  for (int robot = 0; robot < 4; ++robot) {
    const auto source = team->source(options, robot);
    int frames = 0;
    while (const auto frame = source->next()) {
      EXPECT_EQ(frame->number, frames++);
      EXPECT_FALSE(frame->labels.empty());
      // The ground is flat at Z = 0: every pixel with a depth lies on it, to a step of the depth picture.
      for (int u = 0; u < 320; u += 40) {
        const float depth = frame->depth_m.at<float>(120, u);
        if (depth > 0) {
          EXPECT_NEAR((frame->world_from_camera * frame->intrinsics.unproject(u, 120, double{depth})).z(), 0,
                      0.1);
        }
      }
    }
    EXPECT_EQ(frames, 30);
    EXPECT_EQ(source->troubles(), "");
  }
}

TEST(GivenWorldsTest, TheKitchenHasDepthAndNoTruth) {
  const auto kitchen = openPlace(given("rgbd_redkitchen"));
  EXPECT_EQ(kitchen->maxRobots(), 1);
  EXPECT_TRUE(kitchen->classes().empty());
  const SurveyOptions options = kitchen->completed({});
  EXPECT_EQ(options.observations, 72);
  EXPECT_GT(options.cell_size_m, 0.05);
  EXPECT_LT(options.cell_size_m, 0.5);
  const auto first = kitchen->source(options, 0)->next();
  EXPECT_GT(cv::countNonZero(first->depth_m > 0), 320 * 240 / 2);
  EXPECT_TRUE(first->labels.empty());
}

}  // namespace
}  // namespace shoal::world
