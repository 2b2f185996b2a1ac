// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/clear.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "noisy_graph.h"
#include "shoal/matching/assignment.h"
#include "shoal/random.h"

namespace shoal::matching {
namespace {

// A mission in which `num_robots` robots each see the same `num_classes`
// classes, one topic per class. Vertex r * num_classes + c is robot r's topic
// for class c, so the right answer is label(v) == v % num_classes, up to names.
struct ClassMission {
  AssociationGraph graph;
  std::vector<int> truth;
};

ClassMission makeMission(int num_robots, int num_classes) {
  ClassMission m;
  m.graph.num_topics.assign(static_cast<size_t>(num_robots), num_classes);
  const int n = num_robots * num_classes;
  for (int v = 0; v < n; ++v) {
    m.truth.push_back(v % num_classes);
    for (int w = v + num_classes; w < n; w += num_classes) m.graph.edges.push_back({v, w});
  }
  return m;
}

void removeEdge(AssociationGraph& graph, int i, int j) {
  std::erase_if(graph.edges, [&](const Edge& e) { return e.i == i && e.j == j; });
}

// True iff the two labelings group the vertices alike, whatever the names.
bool sameGrouping(const std::vector<int>& a, const std::vector<int>& b) {
  std::set<std::pair<int, int>> pairs;
  for (size_t v = 0; v < a.size(); ++v) pairs.emplace(a[v], b[v]);
  return a.size() == b.size() && pairs.size() == std::set<int>(a.begin(), a.end()).size() &&
         pairs.size() == std::set<int>(b.begin(), b.end()).size();
}

// By hand: the path 0 - 1 - 2 over three robots has D + I = diag(2, 3, 2).
TEST(NormalizedLaplacianTest, MatchesThePathWorkedByHand) {
  const AssociationGraph path{{1, 1, 1}, {{0, 1}, {1, 2}}};
  const double off = -1.0 / std::sqrt(6.0);
  Eigen::Matrix3d expected;
  expected << 1. / 2, off, 0, off, 2. / 3, off, 0, off, 1. / 2;
  EXPECT_TRUE(Eigen::Matrix3d(normalizedLaplacian(path)).isApprox(expected, 1e-15));
}

// A cluster graph is its own nearest cluster graph.
TEST(RectifyTest, LeavesAClusterGraphAsItIs) {
  for (int num_robots : {1, 2, 5, 12}) {
    const ClassMission m = makeMission(num_robots, 6);
    EXPECT_TRUE(sameGrouping(rectify(m.graph).label, m.truth)) << num_robots << " robots";
  }
}

// The claim of the paper: redundant edges of other robots outvote wrong ones.
// A chain of wrong matches that connected components would follow is cut.
TEST(RectifyTest, OutvotesAWrongEdge) {
  ClassMission m = makeMission(5, 3);
  removeEdge(m.graph, 0, 3);        // robot 0 "sand" !~ robot 1 "sand"
  m.graph.edges.push_back({0, 4});  // robot 0 "sand"  ~ robot 1 "coral"
  EXPECT_TRUE(sameGrouping(rectify(m.graph).label, m.truth));
}

// A phenomenon that one robot alone saw keeps a label of its own.
TEST(RectifyTest, KeepsATopicThatNobodyElseHas) {
  ClassMission m = makeMission(3, 2);
  m.graph.num_topics.back() += 1;
  m.truth.push_back(2);
  EXPECT_TRUE(sameGrouping(rectify(m.graph).label, m.truth));
}

// A robot's own topics never match each other, whatever the graph says.
TEST(RectifyTest, IgnoresEdgesWithinOneRobot) {
  ClassMission m = makeMission(2, 2);
  m.graph.edges.push_back({0, 1});
  m.graph.edges.push_back({2, 3});  // now one 4-clique
  EXPECT_TRUE(sameGrouping(rectify(m.graph).label, m.truth));
  EXPECT_EQ(rectify({{2, 2}, {{0, 1}}}).num_labels, 4);
}

//   0 - 1 - 2 - 3      a chain of doubtful matches is cut in the middle
TEST(RectifyTest, CutsAChain) {
  EXPECT_EQ(rectify({{1, 1, 1, 1}, {{0, 1}, {1, 2}, {2, 3}}}).label, (std::vector{0, 0, 1, 1}));
}

//   1   2
//    \ /       eigenvalues 0, 1/2 (three times), 1.3: ties exactly on the
//     0        threshold, which must not be decided by round-off
//    / \.
//   3   4
TEST(RectifyTest, DoesNotSplitOnATie) {
  EXPECT_EQ(rectify({{1, 1, 1, 1, 1}, {{0, 1}, {0, 2}, {0, 3}, {0, 4}}}).num_labels, 1);
}

// Robot 0 split one topic in two, 0 and 1; everybody else has it once. One
// eigenvalue is small, yet two labels are needed to keep 0 and 1 apart.
TEST(RectifyTest, KeepsARobotsDuplicatesApart) {
  const AssociationGraph graph{{2, 1, 1, 1},
                               {{0, 2}, {0, 3}, {0, 4}, {1, 2}, {1, 3}, {1, 4}, {2, 3}, {2, 4}, {3, 4}}};
  const Clustering clustering = rectify(graph);
  EXPECT_EQ(clustering.num_labels, 2);
  EXPECT_NE(clustering.label[0], clustering.label[1]);
}

// Properties that hold for any input, checked on random noisy graphs.
TEST(RectifyTest, IsAlwaysAConsistentMatching) {
  Random random(20210529);  // any fixed seed: a failure must reproduce
  for (int trial = 0; trial < 50; ++trial) {
    SCOPED_TRACE(trial);
    AssociationGraph graph;
    std::vector<int> owner;
    for (int robot = 0; robot < 2 + trial % 7; ++robot) {
      graph.num_topics.push_back((robot + trial) % 5);  // some robots have none
      owner.insert(owner.end(), static_cast<size_t>(graph.num_topics.back()), robot);
    }
    for (int j = 0; j < graph.numVertices(); ++j)
      for (int i = 0; i < j; ++i)
        if (random.uniform() < 0.15) graph.edges.push_back({i, j, random.uniform()});

    const Clustering clustering = rectify(graph);

    std::set<std::pair<int, int>> used_by_robot;
    int next = 0;  // labels are numbered by first appearance
    ASSERT_EQ(clustering.label.size(), owner.size());
    for (size_t v = 0; v < owner.size(); ++v) {
      EXPECT_TRUE(used_by_robot.emplace(owner[v], clustering.label[v]).second)
          << "two topics of one robot share a label, vertex " << v;
      EXPECT_LE(clustering.label[v], next);
      if (clustering.label[v] == next) ++next;
    }
    EXPECT_EQ(clustering.num_labels, next);
    EXPECT_EQ(rectify(graph).label, clustering.label);
  }
}

// The seven steps of CLEAR without a thought for speed: one dense decomposition of the whole graph, U U' in
// full, every robot's topics against all centres.
Clustering rectifyDensely(const AssociationGraph& graph) {
  const std::vector<int> owner = owners(graph);
  const auto n = static_cast<Eigen::Index>(owner.size());
  Eigen::MatrixXd adjacency = Eigen::MatrixXd::Zero(n, n);
  for (const Edge& e : graph.edges) {
    if (owner[static_cast<size_t>(e.i)] == owner[static_cast<size_t>(e.j)]) continue;
    adjacency(e.i, e.j) = adjacency(e.j, e.i) = e.weight;
  }
  const Eigen::VectorXd degree = adjacency.rowwise().sum();
  const Eigen::VectorXd scale = (degree.array() + 1.0).rsqrt();
  const Eigen::MatrixXd laplacian =
      scale.asDiagonal() * (Eigen::MatrixXd(degree.asDiagonal()) - adjacency) * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(laplacian);
  const int universe = static_cast<int>(std::max<Eigen::Index>(
      (solver.eigenvalues().array() < .5 - 1e-6).count(), *std::ranges::max_element(graph.num_topics)));
  const Eigen::MatrixXd rows = solver.eigenvectors().leftCols(universe).rowwise().normalized();
  const Eigen::MatrixXd likeness = rows * rows.transpose();

  std::vector<Eigen::Index> pivots{0};
  Eigen::VectorXd sum = likeness.col(0).cwiseAbs();
  while (static_cast<int>(pivots.size()) < universe) {
    Eigen::Index next = -1;
    for (Eigen::Index v = 0; v < n; ++v) {
      if (std::ranges::find(pivots, v) != pivots.end()) continue;
      if (next < 0 || std::round(sum[v] * 1e9) < std::round(sum[next] * 1e9)) next = v;
    }
    pivots.push_back(next);
    sum += likeness.col(next).cwiseAbs();
  }
  std::vector<int> label;
  for (const int count : graph.num_topics) {
    Eigen::MatrixXd cost(count, universe);
    for (int k = 0; k < count; ++k) {
      const auto v = static_cast<Eigen::Index>(label.size()) + k;
      for (int p = 0; p < universe; ++p) cost(k, p) = 1.0 - likeness(v, pivots[static_cast<size_t>(p)]);
    }
    const std::vector<int> column = assign(cost);
    label.insert(label.end(), column.begin(), column.end());
  }
  return numberByFirstAppearance(label, universe);
}

// Noise enough that the answer is far from the truth, on both sides of the size at which the eigensolver
// changes.
TEST(RectifyTest, IsWhatTheSevenStepsSay) {
  for (const auto& [num_robots, num_topics] : {std::pair{4, 6}, {9, 8}, {12, 25}}) {
    for (uint64_t seed = 0; seed < 12; ++seed) {
      SCOPED_TRACE(std::to_string(num_robots) + " robots, seed " + std::to_string(seed));
      AssociationGraph graph = makeNoisyGraph(num_robots, num_topics, .3, .3, seed).graph;
      Random random(seed);  // weights, so that nothing ties
      for (Edge& e : graph.edges) e.weight = .5 + random.uniform();
      const Clustering expected = rectifyDensely(graph);
      const Clustering clustering = rectify(graph);
      EXPECT_EQ(clustering.universe, expected.universe);
      EXPECT_EQ(clustering.label, expected.label);
    }
  }
}

// The order in which the edges are given is not part of the graph.
TEST(RectifyTest, DoesNotDependOnTheOrderOfTheEdges) {
  for (uint64_t seed = 0; seed < 10; ++seed) {
    AssociationGraph graph = makeNoisyGraph(8, 6, .3, .3, seed).graph;
    const std::vector<int> label = rectify(graph).label;
    std::reverse(graph.edges.begin(), graph.edges.end());
    EXPECT_EQ(rectify(graph).label, label);
  }
}

// At the noise of the benchmark the classes come out as they went in, with the Krylov solver too.
TEST(RectifyTest, RecoversTheClassesBehindANoisyGraph) {
  for (const auto& [num_robots, num_topics] : {std::pair{30, 8}, {40, 12}}) {
    const NoisyGraph noisy = makeNoisyGraph(num_robots, num_topics, .15, .15, 3);
    const Clustering clustering = rectify(noisy.graph);
    EXPECT_TRUE(sameGrouping(clustering.label, noisy.truth));
    EXPECT_EQ(clustering.universe, num_topics * 3 / 2);
  }
}

TEST(RectifyTest, MergesARobotsDuplicatesWhenNotDistinct) {
  const AssociationGraph graph{{2, 1, 1}, {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
  ClearOptions options;
  EXPECT_EQ(rectify(graph, options).num_labels, 2);
  options.distinct = false;
  EXPECT_EQ(rectify(graph, options).num_labels, 1);
  EXPECT_EQ(rectify({{3}, {{0, 2}}}, options).label, (std::vector{0, 1, 0}));  // one robot by itself
}

TEST(RectifyTest, RejectsOptionsOutOfRange) {
  for (const ClearOptions& bad : {ClearOptions{0.0, 0.0}, ClearOptions{1.0, 0.0}, ClearOptions{.5, .5},
                                  ClearOptions{.5, -1e-9}, ClearOptions{std::nan(""), 0.0}}) {
    EXPECT_THROW(rectify({{1, 1}, {{0, 1}}}, bad), std::invalid_argument);
  }
}

TEST(RectifyTest, HasNothingToSayAboutNoTopics) {
  EXPECT_EQ(rectify({}).num_labels, 0);
  EXPECT_EQ(rectify({{0, 0}, {}}).num_labels, 0);
}

TEST(RectifyTest, RejectsWhatIsNotAnAssociationGraph) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Edge& bad :
       {Edge{0, 4}, Edge{2, 1}, Edge{1, 1}, Edge{-1, 2}, Edge{0, 2, -1.0}, Edge{0, 2, nan}}) {
    EXPECT_THROW(rectify({{2, 2}, {bad}}), std::invalid_argument) << bad.i << ' ' << bad.j;
  }
  EXPECT_THROW(rectify({{2, 2}, {{0, 2}, {0, 2}}}), std::invalid_argument);  // twice
}

}  // namespace
}  // namespace shoal::matching
