// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/tridiagonal.h"

#include <gtest/gtest.h>

#include "symmetric_examples.h"

namespace shoal::matching {
namespace {

using Eigen::MatrixXd;

TEST(TridiagonalizeTest, TurnsTheMatrixWithoutChangingIt) {
  for (const MatrixXd& matrix : symmetricExamples()) {
    SCOPED_TRACE(matrix.rows());
    const Tridiagonal t = tridiagonalize(matrix);
    MatrixXd q = MatrixXd::Identity(matrix.rows(), matrix.rows());
    t.lift(q);
    EXPECT_TRUE((q.transpose() * q).isIdentity(1e-13));
    const MatrixXd back = q * dense(t.diagonal, t.off_diagonal) * q.transpose();
    EXPECT_LE((back - matrix).cwiseAbs().maxCoeff(), 1e-14);
  }
}

}  // namespace
}  // namespace shoal::matching
