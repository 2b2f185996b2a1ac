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
/// @param matrix  s×s, symmetric, eigenvalues in [-1, 1].
Eigenpairs eigenpairsAbove(const Eigen::SparseMatrix<double>& matrix, double bound);

/// Largest matrix that goes to the dense solver straight away. Measured: see docs/benchmarks.md.
inline constexpr int kDenseSize = 200;

/// The same by a dense decomposition. Cost O(s³), memory O(s²).
Eigenpairs denseEigenpairsAbove(const Eigen::SparseMatrix<double>& matrix, double bound);

/// The same by restarted Lanczos (Spectra), or nothing where the count could not be certified.
///
/// Lanczos finds an eigenvalue once, however often it occurs. So what has been found is deflated and the rest
/// is searched again from another start vector, until its greatest eigenvalue is at most `bound`. Each pair
/// returned has a residual r of at most 1e-9 and lies farther than |r| from `bound`: as |λ - θ| <= |r| it is
/// on the right side. That none is missing holds unless its eigenvector is orthogonal to every start vector;
/// these are pseudo-random and fixed, so the answer is the same on every call.
///
/// Cost: a few hundred products with `matrix`, O(nnz + s·c) each; memory O(s·c).
std::optional<Eigenpairs> krylovEigenpairsAbove(const Eigen::SparseMatrix<double>& matrix, double bound);

}  // namespace shoal::matching
