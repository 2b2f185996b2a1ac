// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/cosine_neighbours.h"

#include <gtest/gtest.h>

#include "many_topics.h"
#include "shoal/matching/association_graph.h"
#include "shoal/matching/similarity.h"

namespace shoal::matching {
namespace {

using Pairs = std::vector<std::pair<int, int>>;

Pairs byComparingAll(const std::vector<const Descriptor*>& topics, double sigma) {
  Pairs pairs;
  for (size_t i = 0; i < topics.size(); ++i) {
    for (size_t j = i + 1; j < topics.size(); ++j) {
      if (topics[i]->entries.empty() || topics[j]->entries.empty()) continue;
      if (reaches(cosine(*topics[i], *topics[j]), sigma)) {
        pairs.emplace_back(static_cast<int>(i), static_cast<int>(j));
      }
    }
  }
  return pairs;
}

TEST(CosineNeighboursTest, AreThoseOfAllPairsCompared) {
  for (const double background : {0.0, .3, .8}) {
    DescriptorSet set = makeManyTopics(6, 8, 300, 150, background, 4);
    set.robots[2][3].entries.clear();
    set.robots[3][1] = set.robots[0][0];
    std::vector<const Descriptor*> topics;
    for (const auto& robot : set.robots) {
      for (const Descriptor& topic : robot) topics.push_back(&topic);
    }
    size_t found = 0;
    for (const double sigma : {1e-9, .1, .3, .5, .6, .75, .9, 1.0}) {
      const Pairs pairs = cosineNeighbours(topics, sigma);
      EXPECT_EQ(pairs, byComparingAll(topics, sigma)) << background << ", sigma " << sigma;
      found += pairs.size();
    }
    EXPECT_GT(found, 100u);
  }
}

// (3, 4) and (1, 0) are .6 alike on the dot.
TEST(CosineNeighboursTest, CountWhatIsOnSigma) {
  const Descriptor a{0, {{0, 3}, {1, 4}}};
  const Descriptor b{0, {{0, 1}}};
  EXPECT_EQ(cosineNeighbours({&a, &b}, .6), (Pairs{{0, 1}}));
  EXPECT_EQ(cosineNeighbours({&a, &b}, .600000001), Pairs{});
}

TEST(CosineNeighboursTest, MakeTheAssociationGraphThatPairsMake) {
  const DescriptorSet set = makeManyTopics(5, 6, 200, 100, .3, 9);
  const Similarity by_pairs = [](const Descriptor& x, const Descriptor& y) { return cosine(x, y); };
  for (const bool own_pairs : {false, true}) {
    const AssociationGraph graph = associationGraph(set, &cosine, .5, own_pairs);
    const AssociationGraph expected = associationGraph(set, by_pairs, .5, own_pairs);
    EXPECT_EQ(graph.num_topics, expected.num_topics);
    ASSERT_EQ(graph.edges.size(), expected.edges.size());
    for (size_t k = 0; k < graph.edges.size(); ++k) {
      EXPECT_EQ(graph.edges[k].i, expected.edges[k].i);
      EXPECT_EQ(graph.edges[k].j, expected.edges[k].j);
    }
  }
}

}  // namespace
}  // namespace shoal::matching
