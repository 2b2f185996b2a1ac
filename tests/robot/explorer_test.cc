// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/robot/explorer.h"

#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

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

TEST_P(EveryExplorer, BrickByBrickItBelievesTheSame) {
  const auto images = twoImages();
  Explorer explorer(options());
  explorer.observe(images[0]);
  std::set<mapping::Brick> first;
  for (const mapping::BelievedCell& c : explorer.belief().cells) first.insert(mapping::brickOf(c.cell));
  EXPECT_EQ(explorer.takeSeenBricks(), first);
  EXPECT_TRUE(explorer.takeSeenBricks().empty());
  explorer.observe(images[1]);
  Explorer resumed(options());
  resumed.restore(explorer.checkpoint());
  for (const Explorer* const each : {&explorer, &resumed}) {
    const mapping::LocalBelief belief = each->belief(), outline = each->outline();
    EXPECT_EQ(outline.topics, belief.topics);
    EXPECT_EQ(outline.version, belief.version);
    EXPECT_TRUE(outline.cells.empty());
    std::map<mapping::Brick, std::vector<mapping::BelievedCell>> expected, bricks;
    for (const mapping::BelievedCell& c : belief.cells) expected[mapping::brickOf(c.cell)].push_back(c);
    for (auto brick = each->after({}); brick; brick = each->after(brick))
      bricks[*brick] = each->cellsOf(*brick);
    EXPECT_EQ(bricks, expected);
    EXPECT_TRUE(each->cellsOf({1000, 1000, 1000}).empty());
    EXPECT_EQ(static_cast<size_t>(each->numCells()), belief.cells.size());
  }
  EXPECT_FALSE(explorer.takeSeenBricks().empty());
  EXPECT_TRUE(resumed.takeSeenBricks().empty());
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

std::string complaint(Explorer& explorer, const std::vector<uint8_t>& checkpoint) {
  try {
    explorer.restore(checkpoint);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

// Checkpoints hold all there is, so equal checkpoints are equal minds. The camera's correction counts every
// image so far: an explorer that forgot it would see other words.
TEST_P(EveryExplorer, ResumingEqualsNeverHavingStopped) {
  std::vector<world::Observation> images = twoImages();
  for (int n = 0; n < 2; ++n) {
    world::Observation again = images[static_cast<size_t>(n)];
    again.number = 2 + n;
    images[static_cast<size_t>(n)].color.convertTo(again.color, -1, 0.5);
    images.push_back(again);
  }
  Explorer never(options());
  std::optional<Explorer> stopped(options());
  EXPECT_EQ(complaint(*stopped, never.checkpoint()), "");  // before the first image
  for (const auto& image : images) {
    never.observe(image);
    stopped->observe(image);
    const std::vector<uint8_t> kept = stopped->checkpoint();
    ASSERT_EQ(kept, never.checkpoint()) << image.number;
    stopped.emplace(options());
    EXPECT_EQ(complaint(*stopped, kept), "");
    EXPECT_EQ(stopped->lastObservation(), image.number);
    const mapping::LocalBelief a = stopped->belief(), b = never.belief();
    EXPECT_TRUE(a.version == b.version && a.topics == b.topics && a.cells == b.cells);
    EXPECT_EQ(stopped->droppedWords(), never.droppedWords());
  }
}

TEST_P(EveryExplorer, RefusesCheckpointsOfOthersAndDamagedOnesAndStaysAsItWas) {
  const auto images = twoImages();
  Explorer explorer(options());
  explorer.observe(images[0]);
  const std::vector<uint8_t> whole = explorer.checkpoint();
  Explorer other_seed(options(0, 2)), other_robot(options(1));
  EXPECT_NE(complaint(other_seed, whole).find("another robot, seed"), std::string::npos);
  EXPECT_NE(complaint(other_robot, whole).find("another robot, seed"), std::string::npos);
  ExplorerOptions coarse = options();
  coarse.cell_size_m = 1.6;
  Explorer other_cells(coarse);
  EXPECT_NE(complaint(other_cells, whole).find("cell size"), std::string::npos);
  for (size_t at = 0; at < whole.size(); at += 997) {
    std::vector<uint8_t> broken = whole;
    broken[at] ^= 4;
    EXPECT_NE(complaint(explorer, broken), "") << at;
    EXPECT_NE(complaint(explorer, {whole.begin(), whole.begin() + static_cast<ptrdiff_t>(at)}), "") << at;
  }
  EXPECT_EQ(explorer.checkpoint(), whole);
}

// A look takes a number as an image does: what is told of it is newer than what was told of the last image.
TEST(ExplorerTest, ALookAtItsMapIsABeliefOfItsOwn) {
  ExplorerOptions o = options();
  o.profile = "best";
  const auto images = twoImages();
  Explorer explorer(o);
  explorer.observe(images[0]);
  const mapping::LocalBelief before = explorer.belief();
  ASSERT_GE(before.topics.size(), 2u);
  topics::TeamTopics team;
  for (const mapping::BelievedTopic& topic : before.topics) team.own[topic.id] = number(topic.id);
  for (const mapping::BelievedTopic& topic : before.topics)  // each knows the words of the next
    team.others.push_back({world::RobotId{1}, team.own.at(before.topics.front().id), topic.words});
  ASSERT_TRUE(explorer.canLookAgain());
  EXPECT_FALSE(explorer.hasLookedAgain());
  explorer.lookAgain(team);
  EXPECT_TRUE(explorer.hasLookedAgain());
  const mapping::LocalBelief after = explorer.belief();
  EXPECT_EQ(after.version.observation, before.version.observation + 1);
  EXPECT_EQ(explorer.lastObservation(), after.version.observation);
  EXPECT_EQ(after.topics, before.topics);
  EXPECT_NE(after.cells, before.cells);

  Explorer resumed(o);
  resumed.restore(explorer.checkpoint());
  EXPECT_TRUE(resumed.hasLookedAgain());
  EXPECT_EQ(resumed.belief().cells, after.cells);
  EXPECT_EQ(resumed.belief().version, after.version);

  world::Observation next = images[1];
  next.number = 5;
  resumed.observe(next);
  EXPECT_FALSE(resumed.hasLookedAgain());
  EXPECT_EQ(resumed.belief().version.observation, 5);
}

TEST(ExplorerTest, ARobotThatLabelsWordsDoesNotLookAgain) {
  Explorer explorer(options());
  EXPECT_FALSE(explorer.canLookAgain());
  EXPECT_THROW(explorer.lookAgain({}), std::logic_error);
  EXPECT_FALSE(explorer.hasLookedAgain());
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
