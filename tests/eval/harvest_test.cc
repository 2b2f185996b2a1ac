// SPDX-License-Identifier: BSD-3-Clause
// Matchers on topics of real missions over the built-in reefs, at several stages and team sizes.
#include "harvest.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "shoal/eval/match_quality.h"
#include "shoal/matching/match_memory.h"
#include "shoal/matching/matcher.h"

namespace shoal::eval {
namespace {

using matching::MatcherOptions;

const MatcherOptions kShoal = matching::usualMatcher();
const MatcherOptions kClear{.matcher = "clear"};
const MatcherOptions kHungarian{.matcher = "hungarian", .similarity = "l2"};
const MatcherOptions kIncremental{.matcher = "incremental"};

const std::vector<HarvestedMission>& harvest() {
  static const std::vector<HarvestedMission> missions = readHarvest(SHOAL_HARVEST);
  return missions;
}

struct Quality {
  double ami = 0, f1 = 0;
};

// Means over the missions.
Quality qualityOf(const MatcherOptions& options) {
  Quality mean;
  for (const HarvestedMission& m : harvest()) {
    const std::vector<int> label = matching::match(m.descriptors, options).label;
    mean.ami += score(m.tally, label).ami / static_cast<double>(harvest().size());
    mean.f1 += matchQuality(m.tally, label).f1 / static_cast<double>(harvest().size());
  }
  std::printf("%-12s AMI %.3f, F1 %.3f\n", options.matcher.c_str(), mean.ami, mean.f1);
  return mean;
}

TEST(HarvestTest, HoldsMissionsOfTheReefs) {
  ASSERT_EQ(harvest().size(), 12u);
  for (const HarvestedMission& m : harvest()) {
    EXPECT_NO_THROW(check(m.descriptors));
    EXPECT_TRUE(m.world.starts_with("reef:"));
    EXPECT_GE(std::ssize(m.tally.topics), 8 * m.robots);
  }
}

TEST(HarvestTest, ShoalIsAboveTheOthersInTheMean) {
  const Quality shoal = qualityOf(kShoal);
  for (const MatcherOptions& options : {kClear, kHungarian, kIncremental}) {
    SCOPED_TRACE(options.matcher);
    const Quality other = qualityOf(options);
    EXPECT_GT(shoal.ami, other.ami + 0.03);
    EXPECT_GT(shoal.f1, other.f1 + 0.1);
  }
}

// One robot after the other has learned all that it will: matching it with what is remembered of the team
// before.
TEST(HarvestTest, MemoryChangesNoAnswer) {
  int pairs = 0;
  for (const HarvestedMission& young : harvest()) {
    for (const HarvestedMission& old : harvest()) {
      if (young.world != old.world || young.robots != old.robots || young.part >= old.part) continue;
      ++pairs;
      for (const MatcherOptions& options :
           {kShoal, kClear, MatcherOptions{.matcher = "clear", .distinct = false},
            MatcherOptions{.matcher = "components"}}) {
        SCOPED_TRACE(young.world + " " + options.matcher);
        matching::DescriptorSet team = young.descriptors;
        matching::MatchMemory memory;
        for (size_t r = 0; r <= team.robots.size(); ++r) {
          if (r > 0) team.robots[r - 1] = old.descriptors.robots[r - 1];
          const matching::Clustering anew = matching::match(team, options);
          const matching::Clustering remembered = matching::match(team, options, {}, &memory);
          ASSERT_EQ(remembered.label, anew.label);
          ASSERT_EQ(remembered.universe, anew.universe);
        }
      }
    }
  }
  EXPECT_EQ(pairs, 4);
}

}  // namespace
}  // namespace shoal::eval
