// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace shoal::matching {

// A symmetric tridiagonal matrix T is given by its diagonal (s >= 1) and its off-diagonal (s-1).

/// Eigenvalues of T above `bound`, by Sturm's count: the inertia of bound I - T. Exact for a matrix within
/// round-off of T; what is on the bound is not above. Cost O(s).
int countAbove(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& off_diagonal, double bound);

/// The `count` greatest eigenvalues of T, descending, to round-off, by bisection on Sturm's count, eight at a
/// time. Cost O(s·count).
///
/// @param count  <= s.
Eigen::VectorXd greatestEigenvalues(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& off_diagonal,
                                    int count);

/// Eigenvectors of T by inverse iteration, s×c with unit columns, orthogonal where eigenvalues are closer
/// than 0.01; the others are so by themselves, to about round-off over their distance. The caller verifies.
///
/// @param values  c eigenvalues of T, to round-off, descending.
/// Cost: O(s·c), and O(s·c²) among eigenvalues that are close.
Eigen::MatrixXd inverseIteration(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& off_diagonal,
                                 const Eigen::VectorXd& values);

}  // namespace shoal::matching
