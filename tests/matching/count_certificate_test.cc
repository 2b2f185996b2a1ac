// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/count_certificate.h"

#include <gtest/gtest.h>

#include <vector>

#include "graph_matrices.h"
#include "noisy_graph.h"
#include "shoal/matching/eigenpairs.h"

namespace shoal::matching {
namespace {

using Eigen::MatrixXd;

constexpr double kAbove = .5 + 1e-6;

MatrixXd without(const MatrixXd& vectors, Eigen::Index left_out) {
  MatrixXd rest(vectors.rows(), vectors.cols() - 1);
  rest << vectors.leftCols(left_out), vectors.rightCols(vectors.cols() - left_out - 1);
  return rest;
}

// With all pairs found there is nothing left; whichever one is held back, it is missed.
TEST(RestOfSpectrumTest, MissesAnyPairThatIsHeldBack) {
  std::vector<Eigen::SparseMatrix<double>> matrices{complement(73, twelveCliquesOnAHub())};
  for (const double noise : {.05, .15, .3}) {
    matrices.push_back(complement(makeNoisyGraph(12, 10, noise, noise, 7).graph));
  }
  for (const auto& matrix : matrices) {
    const MatrixXd found = denseEigenpairsAbove(matrix, kAbove).vectors;
    ASSERT_GT(found.cols(), 1);
    EXPECT_EQ(restOfSpectrum(matrix, found, kAbove), Rest::kBelow);
    for (Eigen::Index k = 0; k < found.cols(); ++k) {
      EXPECT_EQ(restOfSpectrum(matrix, without(found, k), kAbove), Rest::kAbove) << k;
    }
  }
}

TEST(RestOfSpectrumTest, SeesThatTiesOnTheThresholdAreNotAboveIt) {
  const auto matrix = complement(300, star(300));
  const MatrixXd found = denseEigenpairsAbove(matrix, .75).vectors;
  ASSERT_EQ(found.cols(), 1);
  EXPECT_EQ(restOfSpectrum(matrix, found, .5 + 1e-6), Rest::kBelow);
  EXPECT_EQ(restOfSpectrum(matrix, found, .5 - 1e-6), Rest::kAbove);
}

TEST(RestOfSpectrumTest, HasNothingLeftWhenAllIsFound) {
  EXPECT_EQ(restOfSpectrum(complement(4, clique(0, 4)), MatrixXd::Identity(4, 4), .5), Rest::kBelow);
}

// The eigenvalues of a long path lie densely on both sides of any bound: four steps cannot tell.
TEST(RestOfSpectrumTest, DoesNotGuess) {
  std::vector<Edge> path;
  for (int v = 0; v + 1 < 400; ++v) path.push_back({v, v + 1});
  const auto matrix = complement(400, path);
  const MatrixXd found = denseEigenpairsAbove(matrix, .9).vectors;
  EXPECT_EQ(restOfSpectrum(matrix, found, .9, 4), Rest::kUndecided);
}

}  // namespace
}  // namespace shoal::matching
