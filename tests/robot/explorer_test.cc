// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/robot/explorer.h"

#include <numeric>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "shoal/robot/profile.h"
#include "shoal/world/survey.h"

namespace shoal::robot {
namespace {

ExplorerOptions options(int robot = 0, uint64_t seed = 1) {
  return {.robot = world::RobotId{robot},
          .profile = "paper",
          .seed = seed,
          .cell_size_m = 0.8,
          .epoch = 0,
          .hyperparameters = {}};
}

// Two images of a reef, 10 m apart, from 8 m above.
std::vector<world::Observation> twoImages() {
  const auto reef = world::openWorld("reef:tuning", 3);
  std::vector<world::Pose> path{world::lookingDown({100, -100, 8}), world::lookingDown({110, -100, 8})};
  const auto source = world::makeSurveySource(*reef, path, world::Intrinsics{}, 1.0);
  std::vector<world::Observation> images;
  while (auto image = source->next()) images.push_back(*image);
  return images;
}

mapping::LocalBelief beliefAfter(const ExplorerOptions& o, const std::vector<world::Observation>& images) {
  Explorer explorer(o);
  for (const auto& image : images) explorer.observe(image);
  return explorer.belief();
}

class EveryExplorer : public ::testing::TestWithParam<std::string> {
 public:
  static ExplorerOptions options(int robot = 0, uint64_t seed = 1) {
    ExplorerOptions o = robot::options(robot, seed);
    o.profile = GetParam();
    return o;
  }
};
INSTANTIATE_TEST_SUITE_P(Profiles, EveryExplorer, ::testing::Values("paper", "best"));

TEST_P(EveryExplorer, LabelsTheCellsUnderTheCamera) {
  const auto images = twoImages();
  const mapping::LocalBelief belief = beliefAfter(options(), images);
  EXPECT_EQ(belief.version, (world::Version{0, 1}));
  ASSERT_GT(belief.cells.size(), 200u);  // two footprints of 12.8 m x 9.6 m in cells of .8 m
  for (const mapping::BelievedCell& c : belief.cells) {
    EXPECT_GE(c.cell.x * 0.8, 100 - 8.0);
    EXPECT_LE(c.cell.x * 0.8, 110 + 8.0);
    EXPECT_GE(c.certainty, 0.f);
    EXPECT_LE(c.certainty, 1.f);
    EXPECT_TRUE(c.seen.us == 0 || c.seen.us == 1'000'000);
  }
}

TEST_P(EveryExplorer, EveryLabelIsATopicAndEveryWeightTheSumOfItsWords) {
  const mapping::LocalBelief belief = beliefAfter(options(), twoImages());
  for (const mapping::BelievedTopic& topic : belief.topics) {
    EXPECT_EQ(topic.weight,
              std::accumulate(topic.words.begin(), topic.words.end(), int64_t{0},
                              [](int64_t sum, const world::WordCount& w) { return sum + w.count; }));
  }
  for (const mapping::BelievedCell& c : belief.cells) {
    EXPECT_NE(std::ranges::find(belief.topics, c.topic, &mapping::BelievedTopic::id), belief.topics.end());
  }
}

TEST_P(EveryExplorer, EqualMissionsAreEqualAndSeedsAndRobotsDiffer) {
  const auto images = twoImages();
  const auto same = [&](const mapping::LocalBelief& a, const mapping::LocalBelief& b) {
    return a.topics == b.topics && a.cells == b.cells;
  };
  const mapping::LocalBelief belief = beliefAfter(options(), images);
  EXPECT_TRUE(same(belief, beliefAfter(options(), images)));
  EXPECT_FALSE(same(belief, beliefAfter(options(0, 2), images)));
  EXPECT_FALSE(same(belief, beliefAfter(options(1), images)));
}

TEST(ExplorerTest, OnlyARobotThatLabelsWordsAdoptsTopics) {
  ExplorerOptions cells = options();
  cells.profile = "best";
  EXPECT_THROW(Explorer(cells).adopt({}), std::invalid_argument);
  EXPECT_NO_THROW(Explorer(options()).adopt({}));
}

TEST(ExplorerTest, ProfilesDifferInTheirFingerprint) {
  ExplorerOptions best = options();
  best.profile = "best";
  EXPECT_NE(Explorer(options()).fingerprint(), Explorer(best).fingerprint());
}

TEST(ExplorerTest, HowItLearnsIsInTheFingerprint) {
  ExplorerOptions cells = options(), others = options();
  cells.hyperparameters = others.hyperparameters = topics::CellLabelHyperparameters{.coupling = 2};
  EXPECT_NE(Explorer(options()).fingerprint(), Explorer(cells).fingerprint());
  EXPECT_EQ(Explorer(others).fingerprint(), Explorer(cells).fingerprint());
}

TEST(ExplorerTest, AnotherCellSizeIsAnotherFingerprint) {
  ExplorerOptions coarse = options();
  coarse.cell_size_m = 1.6;
  EXPECT_NE(Explorer(options()).fingerprint(), Explorer(coarse).fingerprint());
  EXPECT_EQ(Explorer(options()).fingerprint(), Explorer(options(5, 9)).fingerprint());
}

TEST(ExplorerTest, RefusesProfilesAndCellSizesThatDoNotExist) {
  ExplorerOptions wrong = options();
  wrong.profile = "finest";
  EXPECT_THROW(Explorer{wrong}, std::invalid_argument);
  EXPECT_THROW(hyperparametersOf("paperr"), std::invalid_argument);
  wrong = options();
  wrong.cell_size_m = 0;
  EXPECT_THROW(Explorer{wrong}, std::invalid_argument);
}

}  // namespace
}  // namespace shoal::robot
