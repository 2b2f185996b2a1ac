// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/topic_tally.h"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "shoal/eval/team_learning.h"
#include "shoal/random.h"

namespace shoal::eval {
namespace {

using mapping::BelievedCell;
using mapping::LocalBelief;
using world::CellIndex;
using world::RobotId;
using world::TopicId;

LocalBelief belief(int32_t robot, std::vector<BelievedCell> cells) {
  return {.robot = RobotId{robot},
          .version = {0, 0},
          .groups = {{"all", 0, 8}},
          .topics = {},
          .cells = std::move(cells)};
}

BelievedCell cell(int32_t x, int32_t topic, int64_t seen_us) {
  return {{x, 0, 0}, TopicId{topic}, {seen_us}, 0.5f};
}

const TruthOfCell kEvenOrOdd = [](const CellIndex& c) -> std::optional<int> {
  if (c.x >= 100) return std::nullopt;
  return c.x % 2;
};

TEST(TopicTallyTest, TheNewestVisitorsTopicCountsAndTiesGoToTheHigherRobot) {
  const std::vector<LocalBelief> team{belief(0, {cell(0, 1, 10), cell(1, 1, 10), cell(100, 1, 10)}),
                                      belief(1, {cell(1, 5, 10), cell(2, 5, 20)})};
  const TeamTally newest = tally(team, kEvenOrOdd, FusionRule::kNewestWins);
  ASSERT_EQ(newest.topics.size(), 2u);
  EXPECT_EQ(newest.num_classes, 2);
  EXPECT_EQ(newest.topics[0].cells_of_class, (std::vector<int64_t>{1, 0}));
  EXPECT_EQ(newest.topics[0].cells, 2);  // one has no truth
  EXPECT_EQ(newest.topics[1].cells_of_class, (std::vector<int64_t>{1, 1}));
  const TeamTally all = tally(team, kEvenOrOdd, FusionRule::kConcatenate);
  EXPECT_EQ(all.topics[0].cells_of_class, (std::vector<int64_t>{1, 1}));
  EXPECT_EQ(majorityClasses(newest), (std::vector<int>{0, 0}));
  EXPECT_DOUBLE_EQ(purity(newest), 2.0 / 3.0);
}

// Random teams, scored by going over the fused cells one by one.
TEST(TopicTallyTest, ScoresAsGoingOverTheCellsDoes) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    std::vector<LocalBelief> team;
    for (int32_t robot = 0; robot < 3; ++robot) {
      std::vector<BelievedCell> cells;
      for (int32_t x = 0; x < 110; ++x) {
        if (random.below(3) > 0) {
          cells.push_back(
              cell(x, static_cast<int32_t>(random.below(4)), static_cast<int64_t>(random.below(3))));
        }
      }
      team.push_back(belief(robot, std::move(cells)));
    }
    const TeamTally counted = tally(team, kEvenOrOdd, FusionRule::kNewestWins);
    std::vector<int> label;
    for (const TopicTally& t : counted.topics) label.push_back((3 * number(t.robot) + number(t.topic)) % 5);

    std::vector<std::pair<CellIndex, int>> labelled;
    for (int32_t x = 0; x < 110; ++x) {
      const BelievedCell* shown = nullptr;
      int32_t by = 0;
      for (const LocalBelief& b : team) {
        for (const BelievedCell& c : b.cells) {
          if (c.cell.x == x && (shown == nullptr || c.seen >= shown->seen)) {
            shown = &c;
            by = number(b.robot);
          }
        }
      }
      if (shown != nullptr) labelled.emplace_back(shown->cell, (3 * by + number(shown->topic)) % 5);
    }
    const Score expected = score(labelled, kEvenOrOdd), found = score(counted, label);
    EXPECT_NEAR(found.ami, expected.ami, 1e-12);
    EXPECT_NEAR(found.nmi, expected.nmi, 1e-12);
    EXPECT_EQ(found.cells, expected.cells);
    EXPECT_EQ(found.scored, expected.scored);
    EXPECT_EQ(found.labels, expected.labels);
    EXPECT_EQ(found.classes, expected.classes);
  }
}

}  // namespace
}  // namespace shoal::eval
