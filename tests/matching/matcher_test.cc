// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/matcher.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "shoal/random.h"

namespace shoal::matching {
namespace {

// Robots that see most of six classes, each class ten words of its own and five of the background, in an
// order of their own; `noise` words go anywhere.
struct NoisyMission {
  DescriptorSet topics;
  std::vector<int> truth;
  std::vector<int> owner;
};

NoisyMission makeMission(int num_robots, uint64_t seed, int noise) {
  Random random(seed);
  NoisyMission mission;
  mission.topics.vocabulary_size = 65;
  for (int robot = 0; robot < num_robots; ++robot) {
    std::vector<Descriptor>& own = mission.topics.robots.emplace_back();
    const int first = static_cast<int>(random.below(6));
    for (int k = 0; k < 6; ++k) {
      if (random.uniform() < .25) continue;
      const int topic_class = (first + k) % 6;
      std::vector<int64_t> weight(65, 0);
      for (int n = 0; n < 200; ++n) ++weight[static_cast<size_t>(topic_class * 10) + random.below(10)];
      for (int n = 0; n < 30; ++n) ++weight[60 + random.below(5)];
      for (int n = 0; n < noise; ++n) ++weight[random.below(65)];
      Descriptor& d = own.emplace_back();
      d.slot = static_cast<int>(own.size()) - 1;
      for (int word = 0; word < 65; ++word) {
        if (weight[static_cast<size_t>(word)] > 0)
          d.entries.push_back({word, weight[static_cast<size_t>(word)]});
      }
      mission.truth.push_back(topic_class);
      mission.owner.push_back(robot);
    }
  }
  return mission;
}

MatcherOptions optionsFor(const std::string& matcher) {
  MatcherOptions options;
  options.matcher = matcher;
  options.similarity = usualSimilarity(matcher);
  return options;
}

class MatcherLaws : public ::testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(All, MatcherLaws, ::testing::ValuesIn(matcherNames()),
                         [](const auto& name) { return name.param; });

TEST_P(MatcherLaws, GivesEveryTopicOneLabelAndEqualInputEqualOutput) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const NoisyMission mission =
        makeMission(1 + static_cast<int>(seed % 8), seed, 10 * static_cast<int>(seed));
    const Clustering clustering = match(mission.topics, optionsFor(GetParam()));
    ASSERT_EQ(clustering.label.size(), mission.truth.size());
    int next = 0;  // numbered by first appearance
    std::set<std::pair<int, int>> used_by_robot;
    for (size_t v = 0; v < mission.truth.size(); ++v) {
      ASSERT_LE(clustering.label[v], next);
      if (clustering.label[v] == next) ++next;
      const bool is_new = used_by_robot.emplace(mission.owner[v], clustering.label[v]).second;
      EXPECT_TRUE(is_new || !optionsFor(GetParam()).keepsOwnApart()) << "vertex " << v;
    }
    EXPECT_EQ(clustering.num_labels, next);
    EXPECT_GE(clustering.universe, clustering.num_labels);
    EXPECT_EQ(match(mission.topics, optionsFor(GetParam())).label, clustering.label);
  }
}

TEST_P(MatcherLaws, TreatsRobotsWithoutTopicsAsAbsent) {
  const NoisyMission mission = makeMission(5, 42, 20);
  DescriptorSet padded = mission.topics;
  padded.robots.insert(padded.robots.begin() + 2, std::vector<Descriptor>{});
  padded.robots.insert(padded.robots.begin(), std::vector<Descriptor>{});
  padded.robots.emplace_back();
  const MatcherOptions options = optionsFor(GetParam());
  EXPECT_EQ(match(padded, options).label, match(mission.topics, options).label);
}

TEST_P(MatcherLaws, HasNothingToSayAboutNoTopics) {
  EXPECT_EQ(match(DescriptorSet{}, optionsFor(GetParam())).num_labels, 0);
  EXPECT_EQ(match(DescriptorSet{5, {}, {{}, {}}}, optionsFor(GetParam())).universe, 0);
}

TEST_P(MatcherLaws, RejectsDescriptorsThatAreNone) {
  EXPECT_THROW(match(DescriptorSet{5, {}, {{{0, {{5, 1}}}}}}, optionsFor(GetParam())), std::invalid_argument);
}

// Only the words decide: topics without any join nothing and change nothing for the others.
TEST(MatchTest, KeepsTopicsWithoutWordsOutOfIt) {
  for (const std::string matcher : {"hungarian", "incremental", "components", "clear", "shoal"}) {
    SCOPED_TRACE(matcher);
    const NoisyMission mission = makeMission(4, 9, 0);
    DescriptorSet with_empty = mission.topics;
    for (std::vector<Descriptor>& robot : with_empty.robots) robot.insert(robot.begin(), {99, {}});
    const Clustering without = match(mission.topics, optionsFor(matcher));
    const Clustering with = match(with_empty, optionsFor(matcher));
    EXPECT_EQ(with.num_labels, without.num_labels + 4);
    std::set<std::pair<int, int>> pairs;
    size_t v = 0;
    size_t w = 0;
    for (const std::vector<Descriptor>& robot : with_empty.robots) {
      for (const Descriptor& topic : robot) {
        if (!topic.entries.empty()) pairs.emplace(with.label[w], without.label[v++]);
        ++w;
      }
    }
    EXPECT_EQ(pairs.size(), static_cast<size_t>(without.num_labels));
  }
}

TEST(MatchTest, ClearAndShoalFindTheClassesBehindCleanTopics) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const NoisyMission mission = makeMission(8, seed / 2, 5);
    const Clustering clustering = match(mission.topics, optionsFor(seed % 2 == 0 ? "clear" : "shoal"));
    std::set<std::pair<int, int>> pairs;
    for (size_t v = 0; v < mission.truth.size(); ++v) pairs.emplace(clustering.label[v], mission.truth[v]);
    EXPECT_EQ(pairs.size(), 6u);
    EXPECT_EQ(clustering.num_labels, 6);
    EXPECT_EQ(clustering.universe, 6);
  }
}

// The share of pairs of different robots on which a clustering and the truth agree.
double randIndex(const Clustering& clustering, const NoisyMission& mission) {
  int agree = 0;
  int all = 0;
  for (size_t v = 0; v < mission.truth.size(); ++v) {
    for (size_t w = 0; w < v; ++w) {
      if (mission.owner[v] == mission.owner[w]) continue;
      ++all;
      agree += (clustering.label[v] == clustering.label[w]) == (mission.truth[v] == mission.truth[w]);
    }
  }
  return static_cast<double>(agree) / all;
}

// A threshold and running means are what the sequential Hungarian lacks.
TEST(MatchTest, TheIncrementalHungarianBeatsTheSequentialOne) {
  double incremental = 0, sequential = 0;
  for (uint64_t seed = 0; seed < 10; ++seed) {
    const NoisyMission mission = makeMission(8, seed, 40);
    incremental += randIndex(match(mission.topics, optionsFor("incremental")), mission) / 10;
    sequential += randIndex(match(mission.topics, optionsFor("hungarian")), mission) / 10;
  }
  EXPECT_GT(incremental, sequential);
}

// The order of the paper, on the mean over missions.
TEST(MatchTest, ClearBeatsTheSequentialHungarianWhichBeatsIds) {
  double clear = 0, hungarian = 0, id = 0;
  for (uint64_t seed = 0; seed < 10; ++seed) {
    const NoisyMission mission = makeMission(8, seed, 40);
    clear += randIndex(match(mission.topics, optionsFor("clear")), mission) / 10;
    hungarian += randIndex(match(mission.topics, optionsFor("hungarian")), mission) / 10;
    id += randIndex(match(mission.topics, optionsFor("id")), mission) / 10;
  }
  EXPECT_GT(clear, hungarian);
  EXPECT_GT(hungarian, id);
}

// Robot 0 has sand twice. Distinct: two labels. Not distinct: one.
TEST(MatchTest, MergesARobotsDuplicatesOnlyWhenAsked) {
  const Descriptor sand{0, {{0, 9}, {1, 1}}};
  const Descriptor fine_sand{1, {{0, 9}, {1, 2}}};
  const DescriptorSet topics{2, {}, {{sand, fine_sand}, {sand}, {sand}}};
  MatcherOptions options;
  EXPECT_EQ(match(topics, options).num_labels, 2);
  options.distinct = false;
  EXPECT_EQ(match(topics, options).num_labels, 1);
  EXPECT_EQ(match(DescriptorSet{2, {}, {{sand, fine_sand}}}, options).num_labels, 1);  // one robot by itself
}

TEST(MatchTest, ClearTakesTheDiscountedSimilarityToo) {
  const NoisyMission mission = makeMission(8, 3, 5);
  MatcherOptions options = optionsFor("clear");
  options.similarity = "discounted";
  options.sigma = .4;
  EXPECT_EQ(match(mission.topics, options).num_labels, 6);
}

TEST(ParseSigmaTest, ReadsAutoAndNumbers) {
  EXPECT_EQ(parseSigma("auto"), std::nullopt);
  EXPECT_EQ(parseSigma("0.75"), .75);
  for (const std::string text : {"", "0", "-1", "1.01", "0.75x", "Auto", "nan"})
    EXPECT_THROW(parseSigma(text), std::invalid_argument) << text;
  EXPECT_EQ(optionsFor("shoal").leastSimilarity(), .25);
  EXPECT_EQ(optionsFor("clear").leastSimilarity(), .75);
}

TEST(MatchTest, MatchesAGraphThatIsGiven) {
  for (const std::string matcher : {"clear", "components"}) {
    const Clustering c = match(AssociationGraph{{2, 2}, {{0, 3}, {1, 2}}}, optionsFor(matcher));
    EXPECT_EQ(c.label, (std::vector{0, 1, 1, 0}));
  }
}

void expectRefused(const MatcherOptions& options, const std::vector<std::string>& named) {
  try {
    match(DescriptorSet{}, options);
    FAIL() << "not refused";
  } catch (const std::invalid_argument& e) {
    for (const std::string& word : named) {
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos)
          << word << " is missing in: " << e.what();
    }
  }
}

TEST(MatchTest, RefusesByNameWhatIsNotBuilt) {
  MatcherOptions options;
  options.matcher = "clera";
  expectRefused(options,
                {"\"clera\"", "unknown", "id", "hungarian", "incremental", "components", "clear", "shoal"});
  options = {};
  options.similarity = "jaccard";
  expectRefused(options, {"\"jaccard\"", "cosine"});
  for (const std::string name : {"hungarian", "incremental"}) {
    options = optionsFor(name);
    options.similarity = "discounted";
    expectRefused(options, {"\"" + name + "\"", "\"discounted\"", "clear, components, shoal"});
  }
  options = optionsFor("components");
  options.distinct = true;
  expectRefused(options, {"\"components\"", "apart"});
  options = optionsFor("shoal");
  options.similarity = "cosine";
  expectRefused(options, {"\"shoal\"", "\"discounted\"", "\"cosine\""});
  for (const std::string name : {"id", "incremental"}) {
    options = optionsFor(name);
    options.distinct = false;
    expectRefused(options, {"\"" + name + "\"", "clear"});
  }
  for (const double sigma : {0.0, -1.0, 1.5, std::numeric_limits<double>::quiet_NaN()}) {
    options = {};
    options.sigma = sigma;
    expectRefused(options, {"sigma"});
  }
  for (const std::string name : {"id", "hungarian", "incremental", "shoal"}) {
    EXPECT_THROW(match(AssociationGraph{{1, 1}, {{0, 1}}}, optionsFor(name)), std::invalid_argument);
  }
}

}  // namespace
}  // namespace shoal::matching
