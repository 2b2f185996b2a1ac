// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/hungarian.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "shoal/matching/id_matching.h"

namespace shoal::matching {
namespace {

const Descriptor kSand{0, {{0, 9}, {1, 1}}};
const Descriptor kCoral{1, {{2, 5}, {3, 5}}};
const Descriptor kWeed{2, {{4, 3}}};
const Descriptor kRubble{3, {{5, 3}}};

TEST(MatchSequentiallyTest, MatchesEveryRobotToTheFirst) {
  const DescriptorSet topics{6, {}, {{kSand, kCoral, kWeed}, {kWeed, kSand}, {kCoral}}};
  const Clustering clustering = matchSequentially(topics, &l2);
  EXPECT_EQ(clustering.label, (std::vector{0, 1, 2, 2, 0, 1}));
  EXPECT_EQ(clustering.num_labels, 3);
}

// Weed and rubble are matched for want of anything better.
TEST(MatchSequentiallyTest, RejectsNoPairHoweverUnlike) {
  EXPECT_EQ(matchSequentially({6, {}, {{kSand, kWeed}, {kRubble, kSand}}}, &l2).label,
            (std::vector{0, 1, 1, 0}));
}

// Robots 1 and 2 both find weed that robot 0 has not seen: two labels, for the reference does not learn.
TEST(MatchSequentiallyTest, NeverJoinsWhatTwoLaterRobotsFoundNew) {
  const DescriptorSet topics{6, {}, {{kSand}, {kWeed, kSand}, {kSand, kWeed}}};
  EXPECT_EQ(matchSequentially(topics, &l2).label, (std::vector{0, 1, 0, 0, 2}));
}

TEST(MatchSequentiallyTest, TakesTheFirstRobotThatHasTopicsAsReference) {
  EXPECT_EQ(matchSequentially({6, {}, {{}, {kSand, kCoral}, {}, {kCoral, kSand}}}, &l2).label,
            (std::vector{0, 1, 1, 0}));
}

// The best total, not the best pair first: 1-1 costs least alone, but 0-1 and 1-0 cost less together than
// 0-0, 1-1.
TEST(MatchSequentiallyTest, MinimisesTheTotalCost) {
  const Descriptor a0{0, {{0, 1}}};
  const Descriptor a1{1, {{0, 5}, {1, 5}}};
  const Descriptor b0{0, {{1, 1}}};
  const Descriptor b1{1, {{0, 6}, {1, 4}}};
  ASSERT_GT(l2(a1, b1), l2(a0, b1));
  ASSERT_LT(l2(a0, b0) + l2(a1, b1), l2(a0, b1) + l2(a1, b0));
  EXPECT_EQ(matchSequentially({2, {}, {{a0, a1}, {b0, b1}}}, &l2).label, (std::vector{0, 1, 1, 0}));
}

TEST(MatchByIdTest, JoinsEqualSlotsWhateverTheWords) {
  const Descriptor seven{7, {{0, 1}}};
  const Descriptor two{2, {{1, 1}}};
  const Descriptor other_seven{7, {{2, 1}}};
  const Clustering clustering = matchById({3, {}, {{seven, two}, {}, {other_seven}}});
  EXPECT_EQ(clustering.label, (std::vector{0, 1, 0}));
  EXPECT_EQ(clustering.universe, 2);
}

TEST(MatchByIdTest, RejectsASlotThatARobotHasTwice) {
  EXPECT_THROW(matchById({3, {}, {{kSand, kSand}}}), std::invalid_argument);
}

}  // namespace
}  // namespace shoal::matching
