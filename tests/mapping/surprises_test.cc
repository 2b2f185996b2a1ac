// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/surprises.h"

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <gtest/gtest.h>

#include "shoal/mapping/belief_files.h"
#include "shoal/mapping/belief_pieces.h"
#include "shoal/mapping/fusion.h"

namespace shoal::mapping {
namespace {

using world::RobotId;
using world::TopicId;

// A row of four cells from x = first, one topic of one word.
LocalBelief beliefOf(RobotId robot, int32_t first, std::vector<float> surprises, int64_t seen_us) {
  LocalBelief belief{.robot = robot,
                     .version = {0, 1},
                     .groups = {{.name = "all", .first = 0, .size = 4}},
                     .topics = {{TopicId{0}, {0}, 9, {{1, 9}}}},
                     .cells = {}};
  for (const float surprise : surprises) {
    belief.cells.push_back({{first++, 0, 0}, TopicId{0}, {seen_us}, 0.5f, surprise});
  }
  return belief;
}

// R00 sees x = 0 to 5, later R01 x = 4 to 7: of x = 4 and 5 its word counts.
class SurprisesTest : public ::testing::Test {
 protected:
  SurprisesTest() {
    for (const LocalBelief& belief : {r0_, r1_})
      for (const Piece& piece : wholePieces(belief)) beliefs_.apply(piece);
    view_.cell_size_m = 2;
    view_.map = fuse(beliefs_, matching::usualMatcher());
  }

  const LocalBelief r0_ = beliefOf(RobotId{0}, 0, {1.4f, 1.5f, 3.f, 0.f, 5.f, 5.f}, 1'000'000);
  const LocalBelief r1_ = beliefOf(RobotId{1}, 4, {0.f, 2.f, 100.f, 1.f}, 2'000'000);
  BeliefStore beliefs_;
  MissionView view_;
};

TEST_F(SurprisesTest, AreThoseOfWhomTheMapShows) {
  const auto cells = surprisesOf(view_.map, beliefs_);
  ASSERT_EQ(cells.size(), 4u);
  const auto is = [&](size_t i, int32_t x, int32_t robot, float surprise) {
    return cells[i].cell.cell.x == x && cells[i].cell.robot == RobotId{robot} &&
           cells[i].surprise == surprise;
  };
  EXPECT_TRUE(is(0, 1, 0, 1.5f));
  EXPECT_TRUE(is(1, 2, 0, 3.f));
  EXPECT_TRUE(is(2, 5, 1, 2.f));
  EXPECT_TRUE(is(3, 6, 1, 63.f / 8));
  EXPECT_EQ(surprisesCsv({cells[1]}, world::Grid(2)),
            "x_m,y_m,z_m,label,robot,seen_s,surprise\n4.000,0.000,0.000,0,R00,1.000,3.000\n");
}

TEST_F(SurprisesTest, PlacesAreCellsThatTouchTheStrangestFirst) {
  const auto all = surprisesAnswer(view_, beliefs_, 0);
  ASSERT_EQ(all["places"].size(), 2u);
  EXPECT_EQ(all["cells"], 4);
  const auto& first = all["places"][0];
  EXPECT_EQ(first["x_m"], 12);
  EXPECT_EQ(first["surprise"], 7.875);
  EXPECT_EQ(first["cells"], 2);
  EXPECT_EQ(first["area_m2"], 8);
  EXPECT_EQ(first["robots"], nlohmann::json::array({"R01"}));
  EXPECT_EQ(first["first_seen_s"], 2);
  EXPECT_EQ(all["places"][1]["x_m"], 4);
  const auto strange = surprisesAnswer(view_, beliefs_, 2.5);
  EXPECT_EQ(strange["places"].size(), 2u);
  EXPECT_EQ(strange["cells"], 2);
  EXPECT_TRUE(surprisesAnswer(view_, beliefs_, 9)["places"].empty());
  EXPECT_THROW(surprisesAnswer(view_, beliefs_, -1), std::invalid_argument);
  EXPECT_THROW(surprisesAnswer(view_, beliefs_, NAN), std::invalid_argument);
}

// What is read from a robot's files is told as the robot told it.
TEST_F(SurprisesTest, FilesKeepWhatTravels) {
  const std::string folder = ::testing::TempDir() + "/surprises";
  std::filesystem::create_directories(folder);
  const world::Grid grid(2);
  writeBelief(folder, r0_, grid);
  LocalBelief back = readBelief(folder, RobotId{0}, grid);
  back.version = r0_.version;
  EXPECT_EQ(wholePieces(back), wholePieces(r0_));
  std::filesystem::remove(folder + "/surprise.csv");  // of a run made before there was one
  EXPECT_EQ(readBelief(folder, RobotId{0}, grid).cells[2].surprise, 0);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace shoal::mapping
