// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/evaluation.h"

#include <cmath>
#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "shoal/eval/cell_truth.h"
#include "shoal/world/ortho_world.h"

namespace shoal::eval {
namespace {

using world::CellIndex;

TEST(ScoreTest, LeavesOutCellsWithoutTruthAndCountsThem) {
  const TruthOfCell truth = [](const CellIndex& c) {
    return c.x < 4 ? std::optional<int>(c.x / 2) : std::nullopt;
  };
  std::vector<std::pair<CellIndex, int>> labels;
  for (int x = 0; x < 6; ++x) labels.push_back({{x, 0, 0}, 10 + x / 2});
  const Score s = score(labels, truth);
  EXPECT_EQ(s.cells, 6);
  EXPECT_EQ(s.scored, 4);
  EXPECT_EQ(s.labels, 3);
  EXPECT_EQ(s.classes, 2);
  EXPECT_NEAR(s.ami, 1.0, 1e-12);  // where there is truth, the labels agree with it
}

TEST(ScoreTest, OfNothingIsZero) {
  const Score s = score({}, [](const CellIndex&) { return std::optional<int>(1); });
  EXPECT_EQ(s.scored, 0);
  EXPECT_EQ(s.ami, 0.0);
}

// Two robots; the first calls sand 0 and rock 1, the second the other way round. By words CLEAR and Hungarian
// put that right, ID cannot.
TEST(ScoreMatchersTest, TellsMatchersApart) {
  eval::Run run;
  for (int r = 0; r < 2; ++r) {
    mapping::LocalBelief b{world::RobotId{r}, {0, 0}, {{"g", 0, 10}}, {}, {}};
    for (int t = 0; t < 2; ++t) {
      b.topics.push_back({world::TopicId{t}, {0}, 9, {{t == r ? 3 : 8, 9}}});
      for (int y = 0; y < 5; ++y) b.cells.push_back({{r * 2 + t, y, 0}, world::TopicId{t}, {0}, 1.f});
    }
    run.robots.push_back(std::move(b));
  }
  // Robot 0: column 0 is word 3, column 1 word 8; robot 1: column 2 word 8, column 3 word 3.
  const TruthOfCell truth = [](const CellIndex& c) {
    return std::optional<int>(c.x == 0 || c.x == 3 ? 0 : 1);
  };
  const auto scores = scoreMatchers(run, allMatchers(), truth);
  ASSERT_EQ(scores.size(), 5u);
  EXPECT_LT(scores[0].ami, 0.1);
  for (size_t m = 1; m < scores.size(); ++m) EXPECT_NEAR(scores[m].ami, 1.0, 1e-12) << m;
}

// A small reef: three robots, whose truth is what all their frames together say.
TEST(TruthForTest, IsTheProjectionOfEverybodysFrames) {
  const auto place = world::openPlace("reef:tuning", 5);
  world::SurveyOptions team;
  team.num_robots = 3;
  team.observations = 2;
  team.intrinsics = {32, 24, 20.0, 20.0, 15.5, 11.5};
  team = place->completed(team);
  const world::Grid grid(team.cell_size_m);
  ProjectedTruth expected(grid);
  std::vector<CellIndex> seen;
  const auto all = place->source(team, 0, true);
  while (const auto frame = all->next()) {
    expected.add(*frame);
    for (int v = 0; v < 24; ++v)
      for (int u = 0; u < 32; ++u)
        seen.push_back(grid.cellOf(frame->world_from_camera *
                                   team.intrinsics.unproject(u, v, double{frame->depth_m.at<float>(v, u)})));
  }
  const TruthOfCell truth = truthFor(*place, team, grid);
  ASSERT_GT(seen.size(), 1000u);
  for (const CellIndex& cell : seen) ASSERT_EQ(truth(cell), expected.at(cell));
  EXPECT_EQ(truth({1 << 20, 0, 0}), std::nullopt);
}

// A flat world of 8 m x 6 m, in cells of 2 m centred at even metres: 5 x 4 columns, of which those on the
// edge count when their centre lies inside.
TEST(CoverageOfTest, CountsTheColumnsOfTheExtent) {
  const auto place = world::makePlace(std::make_unique<world::OrthoWorld>(
      "meadow", cv::Mat(6, 8, CV_8UC3, cv::Scalar(0)), cv::Mat(), 1.0, std::vector<world::TruthClass>{}));
  // X in -.5 .. 7.5, Y in -5.5 .. .5: centres 0, 2, 4, 6 and 0, -2, -4.
  const std::vector<CellIndex> cells{{0, 0, 0}, {0, 0, 3}, {1, -1, 0}, {9, 9, 0}};
  EXPECT_DOUBLE_EQ(coverageOf(cells, *place, {}, world::Grid(2.0)), 2.0 / 12.0);
}

// What a robot saw and gave no word to is not covered: here the left half of one picture from 1 m.
TEST(CoverageOfTest, OfARecordingCountsTheColumnsItSaw) {
  class OneFrame : public world::Place {
   public:
    const std::string& name() const override { return name_; }
    const std::vector<world::TruthClass>& classes() const override { return classes_; }
    int maxRobots() const override { return 1; }
    bool isRecorded() const override { return true; }
    world::SurveyOptions completed(world::SurveyOptions options) const override { return options; }
    std::unique_ptr<world::ObservationSource> source(const world::SurveyOptions&, int, bool) const override {
      class Source : public world::ObservationSource {
       public:
        std::optional<world::Observation> next() override {
          if (std::exchange(taken_, true)) return std::nullopt;
          world::Observation seen;
          seen.intrinsics = {10, 4, 1.0, 1.0, 0.0, 0.0};  // a metre a pixel: X = u, Y = -v
          seen.depth_m = cv::Mat(4, 10, CV_32FC1, cv::Scalar(1));
          seen.depth_m.at<float>(0, 9) = NAN;
          seen.depth_m.at<float>(1, 9) = 0;
          seen.world_from_camera = world::lookingDown({0, 0, 1});
          return seen;
        }
        std::optional<int32_t> numObservations() const override { return 1; }

       private:
        bool taken_ = false;
      };
      return std::make_unique<Source>();
    }
    std::optional<world::Extent> extent() const override { return std::nullopt; }
    std::optional<uint8_t> truthOfSquare(const world::Grid&, const CellIndex&) const override {
      return std::nullopt;
    }
    bool hasFlatTruth() const override { return false; }

   private:
    std::string name_ = "one";
    std::vector<world::TruthClass> classes_;
  };
  std::vector<CellIndex> cells;
  for (int x = 0; x < 5; ++x)
    for (int y = 0; y < 4; ++y) cells.push_back({x, -y, 0});
  EXPECT_DOUBLE_EQ(coverageOf(cells, OneFrame(), {}, world::Grid(1.0)), 20.0 / 38.0);
}

}  // namespace
}  // namespace shoal::eval
