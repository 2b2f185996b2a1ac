// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shoal/mapping/atomic_file.h"
#include "shoal/mapping/belief_files.h"
#include "shoal/mapping/csv.h"
#include "shoal/mapping/map_files.h"
#include "shoal/mapping/queries.h"

namespace shoal::mapping {
namespace {

class FilesTest : public testing::Test {
 protected:
  FilesTest() : folder_(testing::TempDir() + "shoal_files_" + std::to_string(::getpid())) {}
  ~FilesTest() override { std::filesystem::remove_all(folder_); }
  std::string folder_;
};

TEST(FixedTest, NeverWritesMinusZero) {
  EXPECT_EQ(fixed(-0.0, 3), "0.000");
  EXPECT_EQ(fixed(-0.0004, 3), "0.000");
  EXPECT_EQ(fixed(-0.8, 3), "-0.800");
  EXPECT_EQ(fixed(1234.5, 3), "1234.500");
}

TEST(CsvTest, QuotesAsRfc4180) {
  EXPECT_EQ(quoted("sand"), "sand");
  EXPECT_EQ(quoted("sand, \"pale\""), "\"sand, \"\"pale\"\"\"");
  const auto rows = parseCsv("a,b\r\n\"x,\"\"y\"\"\n\",2\n", {"a", "b"}, "f");
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0][0], "x,\"y\"\n");
}

TEST(CsvTest, NamesWhatIsWrong) {
  EXPECT_THROW(parseCsv("a,c\n", {"a", "b"}, "f"), std::runtime_error);
  EXPECT_THROW(parseCsv("a,b\n1\n", {"a", "b"}, "f"), std::runtime_error);
  EXPECT_THROW(toReal("1.5m", "f"), std::runtime_error);
}

TEST_F(FilesTest, ABeliefComesBackAsItWas) {
  const world::Grid grid(0.8);
  const LocalBelief belief{.robot = world::RobotId{3},
                           .version = {},
                           .groups = {{"orb", 0, 20}, {"hue", 20, 5}},
                           .topics = {{world::TopicId{0}, {1'000'000}, 5, {{2, 2}, {10, 3}}},
                                      {world::TopicId{12}, {0}, 1, {{24, 1}}}},
                           .cells = {{{-3, 0, 1}, world::TopicId{0}, {59'000'000}, 0.25f},
                                     {{0, -7, 0}, world::TopicId{12}, {0}, 1.f}}};
  writeBelief(folder_, belief, grid);
  const LocalBelief back = readBelief(folder_, world::RobotId{3}, grid);
  EXPECT_EQ(back.groups, belief.groups);
  EXPECT_EQ(back.topics, belief.topics);
  EXPECT_EQ(back.cells, belief.cells);
  EXPECT_EQ(readFile(folder_ + "/map.csv"),
            "x_m,y_m,z_m,topic,seen_s,certainty\n"
            "-2.400,0.000,0.800,0,59.000,0.2500\n"
            "0.000,-5.600,0.000,12,0.000,1.0000\n");
  EXPECT_EQ(back.detail, Detail::kFine);
}

TEST_F(FilesTest, ACoarseBeliefSaysSo) {
  const LocalBelief coarse{.robot = world::RobotId{3},
                           .version = {},
                           .groups = {{"hue", 0, 5}},
                           .topics = {{world::TopicId{0}, {0}, 1, {{2, 1}}}},
                           .cells = {{{0, 0, 0}, world::TopicId{0}, {0}, 1.f}},
                           .detail = Detail::kCoarse};
  writeBelief(folder_, coarse, world::Grid(1));
  EXPECT_EQ(readBelief(folder_, world::RobotId{3}, world::Grid(1)).detail, Detail::kCoarse);
  writeFileAtomically(folder_ + "/topics.json", R"({"detail": "blurred", "groups": [], "topics": []})");
  EXPECT_THROW(readBelief(folder_, world::RobotId{3}, world::Grid(1)), std::runtime_error);
}

TEST_F(FilesTest, AGlobalMapComesBackAsItWas) {
  const world::Grid grid(24);
  GlobalMap map;
  map.cells = {{{0, -1, 0}, world::GlobalLabel{10003}, world::RobotId{0}, {5'000'000}, 0.5f},
               {{1, -1, 0}, world::GlobalLabel{10003}, world::RobotId{11}, {7'000'000}, 0.25f}};
  map.labels = {
      {world::GlobalLabel{10003}, "wet, \"sand\"", 2, {world::RobotId{0}, world::RobotId{11}}, {0}}};
  EXPECT_EQ(labelsCsv(map, grid),
            "label,name,cells,area_m2,robots,first_seen_s\n"
            "10003,\"wet, \"\"sand\"\"\",2,1152.000,R00;R11,0.000\n");
  writeFileAtomically(folder_ + "/global_map.csv", globalMapCsv(map, grid));
  writeFileAtomically(folder_ + "/labels.csv", labelsCsv(map, grid));
  const GlobalMap back = readGlobalMap(folder_, grid);
  EXPECT_EQ(back.cells, map.cells);
  EXPECT_EQ(back.labels, map.labels);
}

TEST(MapFilesTest, CertaintiesComeBackToTheLastBit) {
  const world::Grid grid(1);
  GlobalMap map;
  for (int step = 0; step <= kCertaintySteps; ++step) {
    map.cells.push_back({{step, 0, 0},
                         world::GlobalLabel{1},
                         world::RobotId{0},
                         {0},
                         static_cast<float>(step) / kCertaintySteps});
  }
  EXPECT_EQ(parseGlobalMap(globalMapCsv(map, grid), labelsCsv(map, grid), grid, "x").cells, map.cells);
}

TEST(AtAnswerTest, NothingIsAsFarAwayAsNumbersGo) {
  MissionView view;
  view.map.cells.push_back({{0, 0, 0}, world::GlobalLabel{1}, world::RobotId{0}, {0}, 1.f});
  EXPECT_EQ(atAnswer(view, BeliefStore{}, 0.2, -0.4)["cells"].size(), 1u);
  for (const double far : {1e300, -1e300, 3e9, -3e9}) {
    EXPECT_TRUE(atAnswer(view, BeliefStore{}, far, 0)["cells"].empty()) << far;
    EXPECT_TRUE(atAnswer(view, BeliefStore{}, 0, far)["cells"].empty()) << far;
  }
}

// Two cells above one another cover the ground once.
TEST(AreasTest, CountColumnsOnce) {
  GlobalMap map;
  for (int z : {0, 1}) map.cells.push_back({{2, 3, z}, world::GlobalLabel{1}, world::RobotId{0}, {0}, 0});
  EXPECT_DOUBLE_EQ(areas(map, world::Grid(2)).at(world::GlobalLabel{1}), 4.0);
}

TEST_F(FilesTest, ABrokenFileIsNamed) {
  std::filesystem::create_directories(folder_);
  std::ofstream(folder_ + "/topics.json") << "{\"groups\":";
  std::ofstream(folder_ + "/map.csv") << "x_m\n";
  try {
    readBelief(folder_, world::RobotId{0}, world::Grid(1));
    FAIL() << "should have thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("topics.json"), std::string::npos);
  }
}

}  // namespace
}  // namespace shoal::mapping
