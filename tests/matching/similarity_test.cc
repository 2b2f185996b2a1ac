// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/similarity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "shoal/matching/association_graph.h"
#include "shoal/random.h"

namespace shoal::matching {
namespace {

Descriptor descriptor(const std::vector<Descriptor::Entry>& entries) { return {0, entries}; }

Descriptor randomDescriptor(Random& random, int vocabulary, int64_t largest) {
  Descriptor d;
  for (int word = 0; word < vocabulary; ++word) {
    if (random.uniform() < .5) {
      d.entries.push_back({word, 1 + static_cast<int64_t>(random.below(static_cast<uint64_t>(largest)))});
    }
  }
  return d;
}

// a = (3, 1)/4, b = (1, 0, 1)/2 over three words.
//   cosine  3 / (sqrt(10) sqrt(2))
//   overlap min(.75, .5) = .5       l1  1 - (.25 + .25 + .5) / 2 = .5
//   l2      1 - sqrt((.0625 + .0625 + .25) / 2)
//   hellinger 1 - sqrt(1 - Σ √(a b)), where Σ √(a b) = √(.75 · .5)
//   js      only word 0 is shared, .75 and .5, a choice of .6 and .4: -½ (.75 log2 .6 + .5 log2 .4)
TEST(SimilarityTest, HasTheValuesWorkedByHand) {
  const Descriptor a = descriptor({{0, 3}, {1, 1}});
  const Descriptor b = descriptor({{0, 1}, {2, 1}});
  EXPECT_NEAR(cosine(a, b), 3.0 / std::sqrt(20.0), 1e-9);
  EXPECT_DOUBLE_EQ(overlap(a, b), .5);
  EXPECT_DOUBLE_EQ(l1(a, b), .5);
  EXPECT_NEAR(l2(a, b), 1.0 - std::sqrt(.1875), 1e-9);
  EXPECT_NEAR(hellinger(a, b), 1.0 - std::sqrt(1.0 - std::sqrt(.375)), 1e-9);
  EXPECT_NEAR(jensenShannon(a, b), -.375 * std::log2(.6) - .25 * std::log2(.4), 1e-9);
}

// The definitions, in floating point over dense vectors.
TEST(SimilarityTest, AgreesWithTheDefinitions) {
  Random random(2);
  for (int trial = 0; trial < 100; ++trial) {
    const Descriptor a = randomDescriptor(random, 20, 50);
    const Descriptor b = randomDescriptor(random, 20, 7);
    if (a.entries.empty() || b.entries.empty()) continue;
    std::vector<double> x(20, 0.0);
    std::vector<double> y(20, 0.0);
    double sum_x = 0, sum_y = 0;
    for (const auto& e : a.entries) sum_x += x[static_cast<size_t>(e.word)] = static_cast<double>(e.weight);
    for (const auto& e : b.entries) sum_y += y[static_cast<size_t>(e.word)] = static_cast<double>(e.weight);
    double xy = 0, xx = 0, yy = 0, shared = 0, apart = 0, squares = 0, roots = 0, divergence = 0;
    for (size_t v = 0; v < x.size(); ++v) {
      const double p = x[v] / sum_x;
      const double q = y[v] / sum_y;
      xy += p * q;
      xx += p * p;
      yy += q * q;
      shared += std::min(p, q);
      apart += std::abs(p - q);
      squares += (p - q) * (p - q);
      roots += std::sqrt(p * q);
      if (p > 0) divergence += .5 * p * std::log2(2 * p / (p + q));
      if (q > 0) divergence += .5 * q * std::log2(2 * q / (p + q));
    }
    EXPECT_NEAR(cosine(a, b), xy / std::sqrt(xx * yy), 1e-9);
    EXPECT_NEAR(overlap(a, b), shared, 1e-9);
    EXPECT_NEAR(l1(a, b), 1.0 - apart / 2.0, 1e-9);
    EXPECT_NEAR(l2(a, b), 1.0 - std::sqrt(squares / 2.0), 1e-9);
    EXPECT_NEAR(hellinger(a, b), 1.0 - std::sqrt(1.0 - roots), 1e-9);
    EXPECT_NEAR(jensenShannon(a, b), 1.0 - divergence, 1e-9);
  }
}

class SimilarityLaws : public ::testing::TestWithParam<std::string> {
 protected:
  const Similarity similarity_ = similarityNamed(GetParam());
};

INSTANTIATE_TEST_SUITE_P(All, SimilarityLaws, ::testing::ValuesIn(similarityNames()),
                         [](const auto& name) { return name.param; });

TEST_P(SimilarityLaws, IsSymmetricInTheUnitIntervalAndOneOnItself) {
  Random random(3);
  for (int trial = 0; trial < 300; ++trial) {
    // Up to sums near the greatest that are allowed.
    const int64_t largest = trial % 3 == 0 ? int64_t{1} << 56 : 1 + trial;
    const Descriptor a = randomDescriptor(random, 30, largest);
    const Descriptor b = randomDescriptor(random, 30, 9);
    const double value = similarity_(a, b);
    EXPECT_EQ(value, similarity_(b, a));
    EXPECT_GE(value, 0.0);
    EXPECT_LE(value, 1.0);
    EXPECT_EQ(similarity_(a, a), 1.0);
    EXPECT_EQ(std::nearbyint(value * 1e9) / 1e9, value);  // a whole multiple of 1e-9
  }
}

TEST_P(SimilarityLaws, SeesOnlyRatiosWithinATopic) {
  Random random(4);
  for (int trial = 0; trial < 100; ++trial) {
    const Descriptor a = randomDescriptor(random, 30, 20);
    const Descriptor b = randomDescriptor(random, 30, 20);
    Descriptor scaled = a;
    for (auto& e : scaled.entries) e.weight *= 12345;
    EXPECT_NEAR(similarity_(scaled, b), similarity_(a, b), 1.5e-9);
    EXPECT_EQ(similarity_(scaled, a), 1.0);
  }
}

TEST_P(SimilarityLaws, IsZeroForTopicsOfOneWordEachThatShareNone) {
  EXPECT_EQ(similarity_(descriptor({{0, 5}}), descriptor({{1, 2}})), 0.0);
}

TEST_P(SimilarityLaws, TakesEmptyTopicsForAlikeAndUnlikeAllOthers) {
  EXPECT_EQ(similarity_(descriptor({}), descriptor({})), 1.0);
  EXPECT_EQ(similarity_(descriptor({}), descriptor({{1, 2}})), 0.0);
  EXPECT_EQ(similarity_(descriptor({{1, 2}}), descriptor({})), 0.0);
}

TEST(SimilarityTest, L1IsOverlapByIdentity) {
  Random random(5);
  for (int trial = 0; trial < 100; ++trial) {
    const Descriptor a = randomDescriptor(random, 30, 20);
    const Descriptor b = randomDescriptor(random, 30, 20);
    EXPECT_NEAR(l1(a, b), overlap(a, b), 1.5e-9);
  }
}

// (3, 4) and (1, 0) have the cosine .6 on the dot; in binary neither .6 nor its threshold is exact.
TEST(ReachesTest, DecidesTiesForTheEdge) {
  EXPECT_TRUE(reaches(cosine(descriptor({{0, 3}, {1, 4}}), descriptor({{0, 1}})), .6));
  EXPECT_TRUE(reaches(.75, .75));
  EXPECT_TRUE(reaches(.75 - 1e-12, .75));
  EXPECT_FALSE(reaches(.75 - 1e-9, .75));
}

TEST(SimilarityNamedTest, RefusesUnknownNamesAndListsTheBuiltOnes) {
  try {
    similarityNamed("jaccard");
    FAIL() << "jaccard is not built";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("\"jaccard\""), std::string::npos);
    for (const std::string& name : similarityNames()) {
      EXPECT_NE(std::string(e.what()).find(name), std::string::npos);
    }
  }
}

// Two robots; topic 0 of both is alike, the rest is not. Empty topics stay alone although alike.
TEST(AssociationGraphTest, JoinsTopicsOfDifferentRobotsThatAreAlike) {
  const Descriptor sand = descriptor({{0, 9}, {1, 1}});
  const Descriptor dark_sand = descriptor({{0, 9}, {1, 2}});
  const Descriptor coral = descriptor({{2, 4}});
  const DescriptorSet topics{3, {}, {{sand, dark_sand, coral, {}}, {}, {dark_sand, {}}}};
  const AssociationGraph graph = associationGraph(topics, &cosine, .9);
  EXPECT_EQ(graph.num_topics, (std::vector{4, 0, 2}));
  ASSERT_EQ(graph.edges.size(), 2u);
  EXPECT_EQ(graph.edges[0].i, 0);
  EXPECT_EQ(graph.edges[0].j, 4);
  EXPECT_EQ(graph.edges[1].i, 1);
  EXPECT_EQ(graph.edges[1].j, 4);
  EXPECT_EQ(graph.edges[0].weight, 1.0);
  EXPECT_EQ(associationGraph(topics, &cosine, .9, true).edges.size(), 3u);  // and sand with its own dark sand
}

TEST(DescriptorsTest, AreCheckedWordByWord) {
  const auto set = [](const Descriptor& d) { return DescriptorSet{10, {}, {{d}}}; };
  EXPECT_NO_THROW(check(set(descriptor({{0, 1}, {9, 5}}))));
  EXPECT_THROW(check(set(descriptor({{10, 1}}))), std::invalid_argument);
  EXPECT_THROW(check(set(descriptor({{-1, 1}}))), std::invalid_argument);
  EXPECT_THROW(check(set(descriptor({{3, 1}, {3, 1}}))), std::invalid_argument);
  EXPECT_THROW(check(set(descriptor({{3, 0}}))), std::invalid_argument);
  EXPECT_THROW(check(set(descriptor({{3, -4}}))), std::invalid_argument);
  EXPECT_THROW(check(set(descriptor({{3, int64_t{1} << 62}, {4, 1}}))), std::invalid_argument);
  for (const std::vector<int32_t>& groups : {std::vector<int32_t>{1}, {0, 0}, {0, 10}, {0, 5, 3}}) {
    EXPECT_THROW(check(DescriptorSet{10, groups, {}}), std::invalid_argument);
  }
  EXPECT_NO_THROW(check(DescriptorSet{10, {0, 4}, {}}));
}

}  // namespace
}  // namespace shoal::matching
