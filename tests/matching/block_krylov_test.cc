// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/block_krylov.h"

#include <gtest/gtest.h>

#include "graph_matrices.h"
#include "noisy_graph.h"

namespace shoal::matching {
namespace {

using Eigen::MatrixXd;

constexpr double kBound = .5 + 1e-6;

// Given half of the pairs, it finds the other half.
TEST(BlockKrylovTest, FindsWhatIsNotFoundYet) {
  const auto matrix = complement(makeNoisyGraph(25, 12, .15, .15, 3).graph);
  const Eigenpairs all = denseEigenpairsAbove(matrix, kBound);
  const Eigen::Index half = all.values.size() / 2;
  ASSERT_GT(half, 4);
  const MatrixXd found = all.vectors.leftCols(half);
  const auto rest = blockKrylov(matrix, found, kBound, 0);
  ASSERT_TRUE(rest.has_value());
  ASSERT_EQ(rest->values.size(), all.values.size() - half);
  EXPECT_LE((rest->values - all.values.tail(rest->values.size())).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LE((found.transpose() * rest->vectors).cwiseAbs().maxCoeff(), 1e-12);
  const MatrixXd gram = rest->vectors.transpose() * rest->vectors;
  EXPECT_TRUE(gram.isIdentity(1e-12));
  const MatrixXd residual = matrix * rest->vectors - rest->vectors * rest->values.asDiagonal();
  EXPECT_LE(residual.colwise().norm().maxCoeff(), 1e-11);
}

// Of an eigenvalue that occurs eleven times a block of eight sees eight copies at least.
TEST(BlockKrylovTest, SeesAnEigenvalueAsOftenAsTheBlockIsWide) {
  const auto matrix = complement(73, twelveCliquesOnAHub());
  const auto pairs = blockKrylov(matrix, MatrixXd(73, 0), kBound, 0);
  ASSERT_TRUE(pairs.has_value());
  EXPECT_GE(pairs->values.size(), 9);
}

// A ring of 600: 23 eigenvalues within five thousandths of 1, and the basis restarts many times to part
// them.
TEST(BlockKrylovTest, RestartsUntilCloseEigenvaluesAreApart) {
  std::vector<Edge> ring{{0, 599}};
  for (int v = 0; v + 1 < 600; ++v) ring.push_back({v, v + 1});
  const auto matrix = complement(600, ring);
  const Eigenpairs all = denseEigenpairsAbove(matrix, .9953);
  const auto pairs = blockKrylov(matrix, MatrixXd(600, 0), .9953, 0);
  ASSERT_TRUE(pairs.has_value());
  ASSERT_EQ(pairs->values.size(), all.values.size());
  EXPECT_LE((pairs->values - all.values).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(BlockKrylovTest, SeesNothingWhereNothingIs) {
  const auto matrix = complement(60, clique(0, 60));
  const auto pairs = blockKrylov(matrix, MatrixXd::Constant(60, 1, 1 / std::sqrt(60.)), kBound, 0);
  ASSERT_TRUE(pairs.has_value());
  EXPECT_EQ(pairs->values.size(), 0);
}

}  // namespace
}  // namespace shoal::matching
