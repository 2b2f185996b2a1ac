// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/eigenpairs.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "graph_matrices.h"
#include "noisy_graph.h"

namespace shoal::matching {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

// The same values and the same projector: all that CLEAR looks at.
void expectSame(const Eigenpairs& a, const Eigenpairs& b) {
  ASSERT_EQ(a.values.size(), b.values.size());
  EXPECT_LE((a.values - b.values).cwiseAbs().maxCoeff(), 1e-10);
  const Eigen::MatrixXd difference = a.vectors * a.vectors.transpose() - b.vectors * b.vectors.transpose();
  EXPECT_LE(difference.cwiseAbs().maxCoeff(), 1e-8);
}

TEST(KrylovEigenpairsTest, AgreeWithTheDenseSolverOnNoisyGraphs) {
  for (const auto& [robots, topics] : {std::pair{12, 10}, {10, 20}, {25, 12}, {40, 8}}) {
    for (const double noise : {.05, .15, .3}) {
      SCOPED_TRACE(std::to_string(robots) + " robots, noise " + std::to_string(noise));
      const Sparse matrix = complement(makeNoisyGraph(robots, topics, noise, noise, 7).graph);
      const auto krylov = krylovEigenpairsAbove(matrix, .5 + 1e-6);
      ASSERT_TRUE(krylov.has_value());
      expectSame(*krylov, denseEigenpairsAbove(matrix, .5 + 1e-6));
      EXPECT_EQ(krylovEigenpairsAbove(matrix, .5 + 1e-6)->vectors, krylov->vectors);  // to the bit
    }
  }
}

// A ring of 300: the eigenvalues at its end, 1 and twice 1 - 1.5e-4, are so close that the first subspace
// sees nothing above a bound between them.
TEST(KrylovEigenpairsTest, DecideWhereTheFirstLookSeesNothing) {
  std::vector<Edge> edges{{0, 299}};
  for (int v = 0; v + 1 < 300; ++v) edges.push_back({v, v + 1});
  const auto krylov = krylovEigenpairsAbove(complement(300, edges), 1.0 - 7e-5);
  ASSERT_TRUE(krylov.has_value());
  ASSERT_EQ(krylov->values.size(), 1);
  EXPECT_NEAR(krylov->values[0], 1.0, 1e-12);
}

// Twelve equal cliques on one hub: an eigenvalue above .5 occurs eleven times, and a Krylov space sees it
// once.
TEST(KrylovEigenpairsTest, FindEveryCopyOfAMultipleEigenvalue) {
  const Sparse matrix = complement(73, twelveCliquesOnAHub());
  const Eigenpairs dense = denseEigenpairsAbove(matrix, .5 + 1e-6);
  ASSERT_EQ(dense.values.size(), 12);
  ASSERT_NEAR(dense.values[1], dense.values[11], 1e-12);
  const auto krylov = krylovEigenpairsAbove(matrix, .5 + 1e-6);
  ASSERT_TRUE(krylov.has_value());
  expectSame(*krylov, dense);
}

// A star has its eigenvalue .5 on the bound, k - 1 times: none of them is above.
TEST(KrylovEigenpairsTest, LeaveOutTiesOnTheBound) {
  const auto krylov = krylovEigenpairsAbove(complement(300, star(300)), .5 + 1e-6);
  ASSERT_TRUE(krylov.has_value());
  ASSERT_EQ(krylov->values.size(), 1);
  EXPECT_NEAR(krylov->values[0], 1.0, 1e-12);
}

// Rank one: the Krylov space ends after one step.
TEST(KrylovEigenpairsTest, SurviveACliqueOf300) {
  const auto krylov = krylovEigenpairsAbove(complement(300, clique(0, 300)), .5);
  ASSERT_TRUE(krylov.has_value());
  ASSERT_EQ(krylov->values.size(), 1);
  EXPECT_NEAR(krylov->values[0], 1.0, 1e-12);
}

// A threshold too low joins everything: 30 robots of 10 topics, all pairs. Rank two or so, and -.03 many
// times.
TEST(KrylovEigenpairsTest, SurviveACompleteMultipartiteGraph) {
  AssociationGraph graph{std::vector<int>(30, 10), {}};
  for (int i = 0; i < 300; ++i) {
    for (int j = i + 1; j < 300; ++j) {
      if (i / 10 != j / 10) graph.edges.push_back({i, j});
    }
  }
  const auto krylov = krylovEigenpairsAbove(complement(graph), .5);
  ASSERT_TRUE(krylov.has_value());
  expectSame(*krylov, denseEigenpairsAbove(complement(graph), .5));
}

// A path of 400 has a hundred and more eigenvalues above .5, close together: dense is what is left.
TEST(EigenpairsTest, AreRightForALongPathToo) {
  std::vector<Edge> edges;
  for (int v = 0; v + 1 < 400; ++v) edges.push_back({v, v + 1});
  const Sparse matrix = complement(400, edges);
  expectSame(eigenpairsAbove(matrix, .5 + 1e-6), denseEigenpairsAbove(matrix, .5 + 1e-6));
}

}  // namespace
}  // namespace shoal::matching
