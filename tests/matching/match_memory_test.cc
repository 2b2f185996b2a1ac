// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/match_memory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "many_topics.h"
#include "shoal/matching/clear.h"
#include "shoal/matching/cosine_neighbours.h"
#include "shoal/matching/matcher.h"
#include "shoal/random.h"

namespace shoal::matching {
namespace {

// Seven robots in whose topics anything happens: they grow, come, go, change places and become those of
// others; robots are left out and come back; an operator links, parts, and takes it back.
class Mission {
 public:
  explicit Mission(uint64_t seed)
      : random_(seed, 77),
        pool_(makeManyTopics(20, 6, 80, 90, .4, seed)),
        now_(makeManyTopics(7, 5, 80, 90, .4, seed)) {
    now_.group_first = {0, 30};
  }

  void change() {
    std::vector<Descriptor>& robot = now_.robots[below(now_.robots.size())];
    switch (below(8)) {
      case 0:
        robot.push_back(anyTopic());
        break;
      case 1:
        if (!robot.empty()) robot.erase(robot.begin() + static_cast<std::ptrdiff_t>(below(robot.size())));
        break;
      case 2:
        if (!robot.empty()) robot[below(robot.size())] = anyTopic();
        break;
      case 3:
        for (Descriptor& topic : robot)
          for (Descriptor::Entry& e : topic.entries) e.weight += static_cast<int64_t>(below(3));
        break;
      case 4:
        std::ranges::reverse(robot);
        break;
      case 5:
        std::swap(robot, left_out_[below(left_out_.size())]);
        break;
      case 6:
        if (!robot.empty()) robot[below(robot.size())].entries.clear();
        break;
      default:
        changeConstraints();
    }
    std::erase_if(constraints_.together, [this](const auto& pair) { return pair.second >= numTopics(); });
    std::erase_if(constraints_.apart, [this](const auto& pair) { return pair.second >= numTopics(); });
  }

  const DescriptorSet& topics() const { return now_; }
  const PairConstraints& constraints() const { return constraints_; }

 private:
  size_t below(size_t n) { return static_cast<size_t>(random_.below(n)); }
  int numTopics() const {
    size_t n = 0;
    for (const auto& robot : now_.robots) n += robot.size();
    return static_cast<int>(n);
  }
  Descriptor anyTopic() { return pool_.robots[below(20)][below(6)]; }

  void changeConstraints() {
    if (below(3) == 0) constraints_ = {};
    if (numTopics() < 2) return;
    const int i = static_cast<int>(below(static_cast<size_t>(numTopics()) - 1));
    const int j = i + 1 + static_cast<int>(below(static_cast<size_t>(numTopics() - i - 1)));
    (below(2) == 0 ? constraints_.together : constraints_.apart).emplace_back(i, j);
  }

  Random random_;
  DescriptorSet pool_, now_;
  std::vector<std::vector<Descriptor>> left_out_{2};
  PairConstraints constraints_;
};

// What match() says, or why it refuses.
std::pair<Clustering, std::string> answer(const DescriptorSet& topics, const MatcherOptions& options,
                                          const PairConstraints& constraints, MatchMemory* memory) {
  try {
    return {match(topics, options, constraints, memory), ""};
  } catch (const std::invalid_argument& error) {
    return {{}, error.what()};
  }
}

void expectSameWithMemory(const MatcherOptions& options) {
  SCOPED_TRACE(options.matcher + " " + options.similarity);
  int64_t compared = 0, topics = 0;
  for (uint64_t seed = 0; seed < 12; ++seed) {
    Mission mission(seed);
    MatchMemory memory;
    for (int step = 0; step < 60; ++step) {
      for (uint64_t n = mix64(seed * 1000 + static_cast<uint64_t>(step)) % 3; n > 0; --n) mission.change();
      const auto [fresh, refused] = answer(mission.topics(), options, mission.constraints(), nullptr);
      const auto [known, refused_too] = answer(mission.topics(), options, mission.constraints(), &memory);
      ASSERT_EQ(known.label, fresh.label) << "seed " << seed << ", step " << step;
      ASSERT_EQ(known.num_labels, fresh.num_labels);
      ASSERT_EQ(known.universe, fresh.universe);
      ASSERT_EQ(refused_too, refused);
      for (const auto& robot : mission.topics().robots) topics += std::ssize(robot);
    }
    compared += memory.neighbours.numCompared();
  }
  if (options.matcher != "shoal" && options.similarity != "discounted") {
    EXPECT_LT(compared, topics / 4);  // so it was memory that answered
    EXPECT_GT(compared, 0);
  }
}

TEST(MatchMemoryTest, ChangesNoAnswerOfClear) {
  expectSameWithMemory({.matcher = "clear", .sigma = .6});
  expectSameWithMemory({.matcher = "clear", .sigma = .6, .distinct = false});
  expectSameWithMemory({.matcher = "clear", .similarity = "hellinger", .sigma = .4});
  expectSameWithMemory({.matcher = "clear", .similarity = "discounted", .sigma = .4});
}

TEST(MatchMemoryTest, ChangesNoAnswerOfShoalAndComponents) {
  expectSameWithMemory({.matcher = "shoal", .similarity = "discounted"});
  expectSameWithMemory({.matcher = "components", .sigma = .6});
}

// One memory for matchings of everything by everything, one after the other.
TEST(MatchMemoryTest, MayBeHandedFromOneMatcherToAnother) {
  Mission mission(5);
  MatchMemory memory;
  for (int step = 0; step < 60; ++step) {
    mission.change();
    const double sigma = step % 2 == 0 ? .6 : .5;
    for (const MatcherOptions& options :
         {MatcherOptions{.matcher = "clear", .sigma = sigma},
          MatcherOptions{.matcher = "components", .sigma = sigma},
          MatcherOptions{.matcher = "clear", .similarity = step % 3 == 0 ? "l1" : "cosine", .sigma = .5}}) {
      const auto [fresh, refused] = answer(mission.topics(), options, mission.constraints(), nullptr);
      const auto [known, refused_too] = answer(mission.topics(), options, mission.constraints(), &memory);
      ASSERT_EQ(known.label, fresh.label) << "step " << step;
      ASSERT_EQ(refused_too, refused);
    }
  }
}

TEST(NeighbourMemoryTest, ComparesOnlyWhatIsNew) {
  DescriptorSet set = makeManyTopics(6, 8, 300, 150, .3, 4);
  NeighbourMemory memory;
  const auto ask = [&] {
    std::vector<const Descriptor*> topics;
    for (const auto& robot : set.robots)
      for (const Descriptor& topic : robot) topics.push_back(&topic);
    const int64_t before = memory.numCompared();
    EXPECT_EQ(memory.pairs(topics, &cosine, .6), neighbours(topics, &cosine, .6));
    return memory.numCompared() - before;
  };
  EXPECT_EQ(ask(), 48);
  EXPECT_EQ(ask(), 0);
  set.robots[2][3].entries[0].weight += 5;
  set.robots[4].clear();
  EXPECT_EQ(ask(), 1);
  std::swap(set.robots[0], set.robots[5]);
  EXPECT_EQ(ask(), 0);
  set.robots[4] = {set.robots[1][0], set.robots[1][0]};  // the same words a second and a third time
  EXPECT_EQ(ask(), 2);
}

TEST(SpectrumMemoryTest, SolvesAComponentAgainOnlyWhenItHasChanged) {
  // Two paths of three topics; then one gets an edge more.
  AssociationGraph graph{{2, 2, 2, 1}, {{0, 2}, {2, 4}, {1, 3}, {3, 5}}};
  SpectrumMemory memory;
  EXPECT_EQ(rectify(graph, {}, {}, &memory).label, rectify(graph).label);
  EXPECT_EQ(memory.numSolved(), 1);  // both look alike
  graph.edges.push_back({5, 6});
  EXPECT_EQ(rectify(graph, {}, {}, &memory).label, rectify(graph).label);
  EXPECT_EQ(memory.numSolved(), 2);
  memory.forgetUnused();
  memory.forgetUnused();
  EXPECT_EQ(rectify(graph, {}, {}, &memory).label, rectify(graph).label);
  EXPECT_EQ(memory.numSolved(), 4);
  graph.edges[0].weight = .2;  // the same neighbours, but hardly alike
  graph.edges[1].weight = .2;
  const Clustering apart = rectify(graph, {}, {}, &memory);
  EXPECT_EQ(memory.numSolved(), 5);
  EXPECT_EQ(apart.label, rectify(graph).label);
  EXPECT_NE(apart.label[0], apart.label[2]);
}

TEST(CosineNeighboursOfTest, AreThosePairsThatHaveAChosenTopic) {
  DescriptorSet set = makeManyTopics(6, 8, 300, 150, .3, 4);
  set.robots[2][3].entries.clear();
  std::vector<const Descriptor*> topics;
  for (const auto& robot : set.robots)
    for (const Descriptor& topic : robot) topics.push_back(&topic);
  const std::vector<int> chosen{41, 3, 19, 40, 7, 30};
  for (const double sigma : {1e-9, .3, .6, 1.0}) {
    auto expected = cosineNeighbours(topics, sigma);
    std::erase_if(expected, [&](const auto& pair) {
      return std::ranges::count(chosen, pair.first) + std::ranges::count(chosen, pair.second) == 0;
    });
    auto found = cosineNeighboursOf(topics, chosen, sigma);
    std::ranges::sort(found);
    EXPECT_EQ(found, expected) << sigma;
  }
  // (3, 4) and (1, 0) are .6 alike on the dot.
  const Descriptor a{0, {{0, 3}, {1, 4}}};
  const Descriptor b{0, {{0, 1}}};
  EXPECT_EQ(cosineNeighboursOf({&a, &b}, {1}, .6), (std::vector<std::pair<int, int>>{{0, 1}}));
  EXPECT_TRUE(cosineNeighboursOf({&a, &b}, {1}, .600000001).empty());
}

}  // namespace
}  // namespace shoal::matching
