// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace shoal::matching {

/// A symmetric matrix as Q T Q': T tridiagonal, Q orthogonal.
struct Tridiagonal {
  Eigen::VectorXd diagonal;      ///< s, of T
  Eigen::VectorXd off_diagonal;  ///< s-1, of T
  Eigen::MatrixXd reflectors;    ///< s×s; below the diagonal of column k the k-th Householder vector of Q
  Eigen::VectorXd scale;         ///< s, Q = Π (I - scale_k v_k v_k')

  /// Replaces the columns of `vectors` (s×c), in the basis of T, by those in the basis of the matrix: Q times
  /// them. Cost O(s²c).
  void lift(Eigen::MatrixXd& vectors) const;
};

/// Reduces a symmetric matrix to tridiagonal form. Reads the lower triangle.
///
/// The same bits wherever a product and a sum are not fused. Each reflection is applied to a column in the
/// same pass that multiplies it with the next Householder vector, so the matrix goes through the cache once a
/// step: several times as fast as Eigen's at a few hundred rows.
///
/// @param matrix  s×s, s >= 1.
/// Cost: 4/3 s³ flops. Source: Golub and Van Loan, Matrix Computations, 8.3.1.
Tridiagonal tridiagonalize(Eigen::MatrixXd matrix);

}  // namespace shoal::matching
