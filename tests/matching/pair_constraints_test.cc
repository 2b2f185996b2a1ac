// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/pair_constraints.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "shoal/matching/matcher.h"
#include "shoal/random.h"

namespace shoal::matching {
namespace {

constexpr int kWords = 40;

// Topics of five classes with noise, one in six without words.
DescriptorSet randomTopics(Random& random, int num_robots) {
  DescriptorSet topics{kWords, {}, {}};
  for (int r = 0; r < num_robots; ++r) {
    std::vector<Descriptor>& robot = topics.robots.emplace_back();
    for (int k = static_cast<int>(random.below(6)); k > 0; --k) {
      Descriptor& d = robot.emplace_back();
      d.slot = static_cast<int32_t>(robot.size()) - 1;
      if (random.below(6) == 0) continue;
      std::vector<int64_t> weight(kWords);
      const uint64_t topic_class = random.below(5);
      for (int n = 0; n < 100; ++n) ++weight[topic_class * 8 + random.below(8)];
      for (int n = 0; n < 40; ++n) ++weight[random.below(kWords)];
      for (int w = 0; w < kWords; ++w)
        if (weight[static_cast<size_t>(w)] > 0) d.entries.push_back({w, weight[static_cast<size_t>(w)]});
    }
  }
  return topics;
}

std::vector<int> ownersOf(const DescriptorSet& topics) {
  std::vector<int> owner;
  for (size_t r = 0; r < topics.robots.size(); ++r)
    owner.insert(owner.end(), topics.robots[r].size(), static_cast<int>(r));
  return owner;
}

// Constraints that some partition drawn at random satisfies, so that they do not contradict one another.
PairConstraints randomConstraints(Random& random, int n) {
  PairConstraints constraints;
  std::vector<uint64_t> part;
  for (int v = 0; v < n; ++v) part.push_back(random.below(6));
  for (uint64_t pairs = n > 0 ? random.below(12) : 0; pairs > 0; --pairs) {
    const auto i = static_cast<int>(random.below(static_cast<uint64_t>(n)));
    const auto j = static_cast<int>(random.below(static_cast<uint64_t>(n)));
    const bool same = part[static_cast<size_t>(i)] == part[static_cast<size_t>(j)];
    (same ? constraints.together : constraints.apart).emplace_back(i, j);
  }
  return constraints;
}

// The groups by closing over the pairs until nothing changes.
std::vector<int> closure(int n, const PairConstraints& constraints) {
  std::vector<int> group(static_cast<size_t>(n));
  std::iota(group.begin(), group.end(), 0);
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [i, j] : constraints.together) {
      int& one = group[static_cast<size_t>(i)];
      int& other = group[static_cast<size_t>(j)];
      changed = changed || one != other;
      one = other = std::min(one, other);
    }
  }
  return group;
}

class HonoursConstraints : public ::testing::TestWithParam<std::pair<std::string, std::optional<bool>>> {};

INSTANTIATE_TEST_SUITE_P(
    All, HonoursConstraints,
    ::testing::Values(std::pair("id", std::optional<bool>()), std::pair("hungarian", std::optional<bool>()),
                      std::pair("incremental", std::optional<bool>()),
                      std::pair("components", std::optional<bool>()), std::pair("clear", std::optional(true)),
                      std::pair("clear", std::optional(false)), std::pair("shoal", std::optional(true)),
                      std::pair("shoal", std::optional(false))),
    [](const auto& p) {
      return p.param.first + (p.param.second ? *p.param.second ? "_distinct" : "_joining" : "");
    });

TEST_P(HonoursConstraints, ExactlyAndKeepsWhatElseItPromises) {
  Random random(5);
  for (int trial = 0; trial < 150; ++trial) {
    SCOPED_TRACE(trial);
    const DescriptorSet topics = randomTopics(random, 1 + trial % 7);
    const std::vector<int> owner = ownersOf(topics);
    const auto n = static_cast<int>(owner.size());
    const PairConstraints constraints = randomConstraints(random, n);
    MatcherOptions options;
    options.matcher = GetParam().first;
    options.similarity = usualSimilarity(options.matcher);
    options.distinct = GetParam().second;
    const Clustering clustering = match(topics, options, constraints);
    ASSERT_EQ(clustering.label.size(), owner.size());
    EXPECT_GE(clustering.universe, clustering.num_labels);
    EXPECT_EQ(numberByFirstAppearance(clustering.label, clustering.universe).label, clustering.label);
    const auto label = [&](int v) { return clustering.label[static_cast<size_t>(v)]; };
    for (const auto& [i, j] : constraints.together) EXPECT_EQ(label(i), label(j)) << i << ", " << j;
    for (const auto& [i, j] : constraints.apart) EXPECT_NE(label(i), label(j)) << i << ", " << j;
    const std::vector<int> group = closure(n, constraints);
    for (int i = 0; i < n && options.keepsOwnApart(); ++i) {
      for (int j = 0; j < i; ++j) {
        if (owner[static_cast<size_t>(i)] != owner[static_cast<size_t>(j)]) continue;
        EXPECT_EQ(label(i) == label(j), group[static_cast<size_t>(i)] == group[static_cast<size_t>(j)]);
      }
    }
    EXPECT_EQ(match(topics, options, constraints).label, clustering.label);
  }
}

TEST_P(HonoursConstraints, RefusesContradictionsAndVerticesThatAreNone) {
  const DescriptorSet topics{2, {}, {{{0, {{0, 5}}}, {1, {}}}, {{0, {{1, 5}}}}}};
  MatcherOptions options;
  options.matcher = GetParam().first;
  options.similarity = usualSimilarity(options.matcher);
  options.distinct = GetParam().second;
  const auto refused = [&](const PairConstraints& constraints, const std::string& named) {
    try {
      match(topics, options, constraints);
      ADD_FAILURE() << "not refused: " << named;
    } catch (const std::invalid_argument& e) {
      EXPECT_NE(std::string(e.what()).find(named), std::string::npos) << e.what();
    }
  };
  refused({{{0, 2}, {2, 1}}, {{1, 0}}}, "labels 1 and 0 are to be both together and apart");
  refused({{}, {{1, 1}}}, "labels 1 and 1");
  refused({{{0, 3}}, {}}, "labels 0 and 3 are constrained; both in [0, 3)");
  refused({{}, {{-1, 0}}}, "labels -1 and 0");
}

std::vector<int> labelsOf(const AssociationGraph& graph, const std::string& matcher,
                          const PairConstraints& constraints, std::optional<bool> distinct = {}) {
  return match(graph, {.matcher = matcher, .distinct = distinct}, constraints).label;
}

// Robots 0, 1 and 2 know the same two things, 0~2~4 and 1~3~5.
const AssociationGraph kTwoThings{{2, 2, 2}, {{0, 2}, {0, 4}, {1, 3}, {1, 5}, {2, 4}, {3, 5}}};

TEST(PairConstraintsTest, ClearKeepsATopicOutAndTheOthersTogether) {
  EXPECT_EQ(labelsOf(kTwoThings, "clear", {}), (std::vector{0, 1, 0, 1, 0, 1}));
  // 4 is not 0: as if of robot 0 too, it loses an edge, hangs on 2 alone, and may not have 0's label.
  const std::vector<int> split = labelsOf(kTwoThings, "clear", {{}, {{0, 4}}});
  EXPECT_NE(split[0], split[4]);
  EXPECT_EQ(split[1], split[3]);
  EXPECT_EQ(split[1], split[5]);
  EXPECT_NE(split[4], split[1]);
}

TEST(PairConstraintsTest, ALinkCarriesAllThatMatchEitherEnd) {
  const AssociationGraph halves{{1, 1, 1, 1}, {{0, 1}, {2, 3}}};
  for (const std::string matcher : {"clear", "components"}) {
    EXPECT_EQ(labelsOf(halves, matcher, {}), (std::vector{0, 0, 1, 1}));
    EXPECT_EQ(labelsOf(halves, matcher, {{{1, 2}}, {}}), (std::vector{0, 0, 0, 0}));
  }
}

TEST(PairConstraintsTest, WhatIsMatchedAlreadyMayBeLinkedOrKeptApartWithoutAnyChange) {
  const std::vector<int> label{0, 1, 0, 1, 0, 1};
  for (const std::string matcher : {"clear", "components"}) {
    EXPECT_EQ(labelsOf(kTwoThings, matcher, {{{0, 2}, {3, 5}}, {{0, 3}, {4, 5}}}), label);
  }
}

TEST(PairConstraintsTest, RepairMovesTheLaterGroupAndLeavesTheRest) {
  // 0, 1, 2, 3 had one label; 3 goes with 4, and 1 is not 0.
  const Contraction contraction = contract(5, {{{4, 3}}, {{1, 0}}});
  const Clustering one{{0, 0, 0, 0, 1}, 2, 2};
  EXPECT_EQ(repair(contraction, one, {}).label, (std::vector{0, 1, 0, 0, 0}));
  const std::vector<int> owner{0, 1, 2, 3, 0};  // 4 is robot 0's, as 0 is: both groups may not have label 0
  EXPECT_EQ(repair(contraction, one, owner).label, (std::vector{0, 1, 0, 2, 2}));
}

TEST(PairConstraintsTest, ContractsTransitivelyAndNamesEachPairOnce) {
  const Contraction c = contract(6, {{{5, 1}, {1, 3}}, {{0, 5}, {3, 0}, {2, 4}}});
  EXPECT_EQ(c.group, (std::vector{0, 1, 2, 1, 3, 1}));
  EXPECT_EQ(c.members[1], (std::vector{1, 3, 5}));
  EXPECT_EQ(c.apart, (std::vector<std::pair<int, int>>{{0, 1}, {2, 3}}));
}

}  // namespace
}  // namespace shoal::matching
