// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <optional>

namespace shoal::matching {

/// Some eigenpairs of a symmetric matrix, greatest eigenvalue first.
struct Eigenpairs {
  Eigen::VectorXd values;   ///< c, descending
  Eigen::MatrixXd vectors;  ///< s×c, orthonormal columns
};

/// Every eigenpair of `matrix` whose eigenvalue exceeds `bound`.
///
/// Up to kDenseSize rows by a dense solver, above by krylovEigenpairsAbove(), and by the dense solver again
/// where that one cannot vouch for its count.
///
/// @param matrix  s×s, symmetric, compressed, eigenvalues in [-1, 1].
Eigenpairs eigenpairsAbove(const Eigen::SparseMatrix<double>& matrix, double bound);

/// Largest matrix that goes to the dense solver straight away. Measured: see docs/benchmarks.md.
inline constexpr int kDenseSize = 300;

/// The same by a dense decomposition: tridiagonal form, Sturm's count, inverse iteration; and by implicit QL
/// steps on the whole matrix when half of the pairs or more are wanted, or when the vectors so found are not
/// orthonormal eigenvectors to 1e-11. Cost O(s³), memory O(s²).
Eigenpairs denseEigenpairsAbove(const Eigen::MatrixXd& matrix, double bound);

/// The same by blockKrylov(), until restOfSpectrum() says that none is missing; or nothing where the count
/// could not be certified, which includes every bound <= 0.
///
/// Each pair returned has a residual r of at most 1e-11 and lies farther than |r| from `bound`: as
/// |λ - θ| <= |r| it is on the right side. The answer is the same on every call.
///
/// Cost: O(nnz + s·c) a vector of the Krylov space, of which there are two to four times c; memory O(s·c).
std::optional<Eigenpairs> krylovEigenpairsAbove(const Eigen::SparseMatrix<double>& matrix, double bound);

}  // namespace shoal::matching
