// SPDX-License-Identifier: BSD-3-Clause
// The evaluation worlds, and the reefs, under the default survey. SHOAL_DATA names the worlds' folder.
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "shoal/world/survey.h"
#include "shoal/world/world.h"

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

TEST(GivenWorldsTest, RecordingsAreRefusedByName) {
  for (const char* name : {"rgbd_redkitchen", "uav_dubai_tile5"}) {
    try {
      (void)openWorld(given(name));
      FAIL() << name;
    } catch (const std::invalid_argument& e) {
      EXPECT_NE(std::string(e.what()).find("not built yet"), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace shoal::world
