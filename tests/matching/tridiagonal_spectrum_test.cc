// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/tridiagonal_spectrum.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "shoal/matching/tridiagonal.h"
#include "symmetric_examples.h"

namespace shoal::matching {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(CountAboveTest, CountsAsTheEigenvaluesDo) {
  for (const MatrixXd& matrix : symmetricExamples()) {
    const Tridiagonal t = tridiagonalize(matrix);
    const VectorXd values = Eigen::SelfAdjointEigenSolver<MatrixXd>(matrix).eigenvalues();
    for (const double bound : {-1.1, -.03, .01, .1, .5, .999, 1.1}) {
      EXPECT_EQ(countAbove(t.diagonal, t.off_diagonal, bound), (values.array() > bound).count()) << bound;
    }
  }
}

TEST(CountAboveTest, DoesNotCountWhatIsOnTheBound) {
  EXPECT_EQ(countAbove(VectorXd::Constant(3, .5), VectorXd::Zero(2), .5), 0);
  EXPECT_EQ(countAbove(VectorXd::Constant(3, .5), VectorXd::Zero(2), .5 - 1e-12), 3);
}

TEST(GreatestEigenvaluesTest, AreThoseOfTheMatrix) {
  for (const MatrixXd& matrix : symmetricExamples()) {
    SCOPED_TRACE(matrix.rows());
    const Tridiagonal t = tridiagonalize(matrix);
    const VectorXd all = Eigen::SelfAdjointEigenSolver<MatrixXd>(matrix).eigenvalues().reverse();
    for (const Eigen::Index count : {Eigen::Index{1}, (all.size() + 1) / 2, all.size()}) {
      const VectorXd values = greatestEigenvalues(t.diagonal, t.off_diagonal, static_cast<int>(count));
      ASSERT_EQ(values.size(), count);
      EXPECT_LE((values - all.head(count)).cwiseAbs().maxCoeff(), 1e-14);
    }
  }
}

// The upper half of the eigenpairs of each example: vectors that are orthonormal and belong to their
// eigenvalues, also where an eigenvalue occurs six times or T falls into pieces.
TEST(InverseIterationTest, FindsOrthonormalEigenvectors) {
  for (const MatrixXd& matrix : symmetricExamples()) {
    SCOPED_TRACE(matrix.rows());
    const Tridiagonal t = tridiagonalize(matrix);
    const MatrixXd tridiagonal = dense(t.diagonal, t.off_diagonal);
    const VectorXd all = Eigen::SelfAdjointEigenSolver<MatrixXd>(tridiagonal).eigenvalues().reverse();
    const VectorXd values = all.head((all.size() + 1) / 2);
    const MatrixXd vectors = inverseIteration(t.diagonal, t.off_diagonal, values);
    EXPECT_TRUE((vectors.transpose() * vectors).isIdentity(1e-12));
    const MatrixXd residual = tridiagonal * vectors - vectors * values.asDiagonal();
    EXPECT_LE(residual.cwiseAbs().maxCoeff(), 1e-13);
  }
}

}  // namespace
}  // namespace shoal::matching
