// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/connected_components.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>

#include "noisy_graph.h"

namespace shoal::matching {
namespace {

//   0 - 3   1   2 - 4 - 5, and a weight of 0 between 1 and 2
TEST(MatchByComponentsTest, FollowsEveryChain) {
  const Clustering c = matchByComponents({{1, 1, 1, 1, 1, 1}, {{0, 3}, {4, 5}, {2, 4}, {1, 2, 0.0}}});
  EXPECT_EQ(c.label, (std::vector{0, 1, 2, 0, 2, 2}));
  EXPECT_EQ(c.num_labels, 3);
  EXPECT_EQ(c.universe, 3);
}

// Robot 0 has one thing twice; robot 1 joins both.
TEST(MatchByComponentsTest, MergesARobotsOwnTopicsThroughAnother) {
  EXPECT_EQ(matchByComponents({{2, 1}, {{0, 2}, {1, 2}}}).label, (std::vector{0, 0, 0}));
}

// Brute force: the transitive closure by repeated relaxation; and the order of the edges changes nothing.
TEST(MatchByComponentsTest, AgreesWithTheTransitiveClosure) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    AssociationGraph graph = makeNoisyGraph(5, 6, .8, .05, seed).graph;
    std::vector<int> lowest(static_cast<size_t>(graph.numVertices()));
    std::iota(lowest.begin(), lowest.end(), 0);
    for (bool changed = true; changed;) {
      changed = false;
      for (const Edge& e : graph.edges) {
        int& a = lowest[static_cast<size_t>(e.i)];
        int& b = lowest[static_cast<size_t>(e.j)];
        changed = changed || a != b;
        a = b = std::min(a, b);
      }
    }
    const Clustering c = matchByComponents(graph);
    EXPECT_EQ(c.label, numberByFirstAppearance(lowest, graph.numVertices()).label);
    std::reverse(graph.edges.begin(), graph.edges.end());
    EXPECT_EQ(matchByComponents(graph).label, c.label);
  }
}

TEST(MatchByComponentsTest, RejectsWhatIsNotAnAssociationGraph) {
  EXPECT_THROW(matchByComponents({{1, 1}, {{0, 2}}}), std::invalid_argument);
}

}  // namespace
}  // namespace shoal::matching
