// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/incremental_hungarian.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "shoal/random.h"

namespace shoal::matching {
namespace {

Descriptor topic(const std::vector<Descriptor::Entry>& entries) { return {0, entries}; }

const Descriptor kFineSand = topic({{0, 9}, {1, 1}});
const Descriptor kRedCoral = topic({{2, 4}, {3, 4}});
const Descriptor kKelp = topic({{4, 7}});

DescriptorSet robots(std::vector<std::vector<Descriptor>> all) { return {8, {}, std::move(all)}; }

// What robot 1 finds new, robot 2 can join: where the paper's sequential baseline fails.
TEST(MatchIncrementallyTest, JoinsWhatALaterRobotFoundNew) {
  const DescriptorSet topics = robots({{kFineSand}, {kRedCoral, kFineSand}, {kKelp, kRedCoral}});
  EXPECT_EQ(matchIncrementally(topics, &cosine, .75).label, (std::vector{0, 1, 0, 2, 1}));
}

TEST(MatchIncrementallyTest, OpensALabelBelowSigmaAndJoinsAtSigma) {
  const Descriptor a = topic({{0, 3}, {1, 4}});
  const Descriptor b = topic({{0, 1}});  // cosine .6
  EXPECT_EQ(matchIncrementally(robots({{a}, {b}}), &cosine, .6).label, (std::vector{0, 0}));
  EXPECT_EQ(matchIncrementally(robots({{a}, {b}}), &cosine, .600001).label, (std::vector{0, 1}));
}

// One thing in two colours: robot 1 brings both, and only one of them can have the label.
TEST(MatchIncrementallyTest, KeepsTheTopicsOfOneRobotApart) {
  const Descriptor dark_sand = topic({{0, 8}, {1, 2}});
  EXPECT_EQ(matchIncrementally(robots({{kFineSand}, {dark_sand, kFineSand}}), &cosine, .75).label,
            (std::vector{0, 1, 0}));
}

// The sum decides, not the first to choose: labels A = (1, 0), B = (.8, .6); topics p = (.96, .28) between
// them and q = (1, 0). p is nearest to A, but q must have it: A with q and B with p give 1 + .936.
TEST(MatchIncrementallyTest, AssignsForTheBestSum) {
  const DescriptorSet topics =
      robots({{topic({{0, 1}}), topic({{0, 4}, {1, 3}})}, {topic({{0, 24}, {1, 7}}), topic({{0, 1}})}});
  EXPECT_EQ(matchIncrementally(topics, &cosine, .75).label, (std::vector{0, 1, 1, 0}));
}

// A label is the mean of shares, not of counts: (.5, .5) and (0, 1) make (.25, .75), with which (.75, .25)
// has the cosine .6. Counted, the thousand words of robot 1 would leave .317.
TEST(MatchIncrementallyTest, ComparesWithTheMeanOfShares) {
  const Descriptor first = topic({{0, 1}, {1, 1}});
  const Descriptor second = topic({{1, 1000}});
  const Descriptor third = topic({{0, 3}, {1, 1}});
  const DescriptorSet topics = robots({{first}, {second}, {third}});
  EXPECT_EQ(matchIncrementally(topics, &cosine, .599).label, (std::vector{0, 0, 0}));
  EXPECT_EQ(matchIncrementally(topics, &cosine, .601).label, (std::vector{0, 0, 1}));
}

// The order of topics within a robot, and the scale of their counts, are no part of the answer.
TEST(MatchIncrementallyTest, DoesNotDependOnTheOrderWithinARobot) {
  Random random(6);
  for (int trial = 0; trial < 20; ++trial) {
    DescriptorSet topics{12, {}, {}};
    for (int robot = 0; robot < 5; ++robot) {
      std::vector<Descriptor>& own = topics.robots.emplace_back();
      for (int k = 0; k < 4; ++k) {
        Descriptor& d = own.emplace_back();
        d.slot = k;
        for (int word = 0; word < 12; ++word) {
          d.entries.push_back({word, static_cast<int64_t>(1 + random.below(word / 3 == k ? 400 : 100))});
        }
      }
    }
    DescriptorSet turned = topics;
    for (auto& own : turned.robots) {
      std::rotate(own.begin(), own.begin() + 1, own.end());
      for (Descriptor& d : own) {
        for (auto& e : d.entries) e.weight *= 1024;
      }
    }
    const std::vector<int> label = matchIncrementally(topics, &cosine, .8).label;
    const std::vector<int> other = matchIncrementally(turned, &cosine, .8).label;
    std::set<std::pair<int, int>> pairs;
    for (size_t robot = 0; robot < 5; ++robot) {
      for (size_t k = 0; k < 4; ++k) pairs.emplace(label[robot * 4 + (k + 1) % 4], other[robot * 4 + k]);
    }
    EXPECT_EQ(pairs.size(), std::set<int>(label.begin(), label.end()).size());
  }
}

TEST(MatchIncrementallyTest, HasNothingToSayAboutNoTopics) {
  EXPECT_EQ(matchIncrementally({}, &cosine, .75).num_labels, 0);
  EXPECT_EQ(matchIncrementally(robots({{}, {}}), &cosine, .75).universe, 0);
}

}  // namespace
}  // namespace shoal::matching
