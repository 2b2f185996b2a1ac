// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/shoal_matching.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "shoal/random.h"

namespace shoal::matching {
namespace {

constexpr int kClasses = 5, kWords = 60;

// Robots that have cut some of five classes into up to three topics each. A quarter of all words is common
// ground.
struct SeededMission {
  DescriptorSet topics;
  std::vector<int> truth;
};

SeededMission makeMission(uint64_t seed) {
  Random random(seed);
  SeededMission mission{{kWords, {0, 30}, {}}, {}};
  for (int robot = 0; robot < 6; ++robot) {
    std::vector<Descriptor>& own = mission.topics.robots.emplace_back();
    for (int c = 0; c < kClasses; ++c) {
      for (uint64_t piece = random.below(4); piece > 0; --piece) {
        std::vector<int64_t> weight(kWords);
        for (int n = 0; n < 600; ++n) {
          const int first = n % 2 == 0 ? 0 : 30;
          const auto place =
              n % 4 == 3 ? 25 + random.below(5) : static_cast<uint64_t>(5 * c) + random.below(5);
          ++weight[static_cast<size_t>(first) + place];
        }
        Descriptor& d = own.emplace_back();
        d.slot = static_cast<int32_t>(own.size()) - 1;
        for (int w = 0; w < kWords; ++w)
          if (weight[static_cast<size_t>(w)] > 0) d.entries.push_back({w, weight[static_cast<size_t>(w)]});
        mission.truth.push_back(c);
      }
    }
  }
  return mission;
}

TEST(ShoalMatchingTest, PutsPiecesOfAClassTogetherAcrossRobotsAndWithinThem) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const SeededMission mission = makeMission(seed);
    const Clustering clustering = matchShoal(mission.topics, kShoalSigma, false);
    EXPECT_EQ(clustering.label, numberByFirstAppearance(mission.truth, kClasses).label);
  }
}

TEST(ShoalMatchingTest, KeepsARobotsLabelsApartWhenTold) {
  const SeededMission mission = makeMission(4);
  const Clustering clustering = matchShoal(mission.topics, kShoalSigma, true);
  size_t v = 0;
  for (const std::vector<Descriptor>& robot : mission.topics.robots) {
    std::vector<bool> used(static_cast<size_t>(clustering.num_labels));
    for (size_t k = 0; k < robot.size(); ++k) {
      const auto label = static_cast<size_t>(clustering.label[v++]);
      EXPECT_FALSE(used[label]);
      used[label] = true;
    }
  }
}

TEST(ShoalMatchingTest, GivesTheSameClustersToRobotsInAnyOrder) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const SeededMission mission = makeMission(seed);
    SeededMission turned{{kWords, {0, 30}, {}}, {}};
    std::vector<size_t> from;  // vertex here -> vertex there
    std::vector<size_t> first(mission.topics.robots.size() + 1);
    for (size_t r = 0; r < mission.topics.robots.size(); ++r)
      first[r + 1] = first[r] + mission.topics.robots[r].size();
    for (size_t r = mission.topics.robots.size(); r-- > 0;) {
      std::vector<Descriptor> robot = mission.topics.robots[r];
      std::ranges::reverse(robot);
      for (size_t k = robot.size(); k-- > 0;) from.push_back(first[r] + k);
      turned.topics.robots.push_back(std::move(robot));
    }
    const double sigma = 0.05 + 0.04 * static_cast<double>(seed);  // some cut through the classes
    const Clustering there = matchShoal(mission.topics, sigma, false);
    std::vector<int> moved;
    for (const size_t v : from) moved.push_back(there.label[v]);
    EXPECT_EQ(matchShoal(turned.topics, sigma, false).label,
              numberByFirstAppearance(moved, there.num_labels).label);
  }
}

TEST(ShoalMatchingTest, LeavesWhatIsLikeNothingAlone) {
  const DescriptorSet topics{
      4, {}, {{{0, {{0, 500}}}, {1, {{1, 500}}}}, {{0, {{0, 480}, {1, 20}}}, {1, {{3, 500}}}}}};
  EXPECT_EQ(matchShoal(topics, kShoalSigma, false).label, (std::vector{0, 1, 0, 2}));
}

}  // namespace
}  // namespace shoal::matching
