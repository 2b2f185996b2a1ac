// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstdint>
#include <optional>

#include "shoal/matching/eigenpairs.h"

namespace shoal::matching {

/// Eigenpairs with eigenvalue above `bound` that a block Krylov space from eight pseudo-random vectors sees,
/// besides those of an invariant subspace already found.
///
/// Each step multiplies the eight newest basis vectors with the matrix and keeps what is orthogonal to the
/// whole basis, twice over. When the basis has grown to a few times the pairs above the bound, it restarts
/// from its best Ritz vectors. It ends when the residual of every Ritz pair above the bound is at most 1e-12
/// and no pair just below can still rise above it. An eigenvalue that occurs more than eight times may be
/// seen too few times, and what an unlucky start lacks is not seen: restOfSpectrum() tells.
///
/// @param matrix  s×s, symmetric, compressed, eigenvalues in [-1, 1].
/// @param found   s×c, orthonormal; the space is sought on its complement.
/// @param stream  which pseudo-random numbers to start from.
/// @returns pairs whose vectors are orthonormal and orthogonal to `found`, none if nothing was seen above;
///          nullopt without convergence, or with more than s/3 pairs: then a dense solver is cheaper.
///
/// Cost: O(nnz) and O(s·k) a vector for a basis of k, usually two to four times the pairs; memory O(s·k).
/// Source: Golub and Underwood 1977 (block Lanczos); restart as in K. Wu and H. Simon, Thick-restart Lanczos,
/// SIMAX 22, 2000.
std::optional<Eigenpairs> blockKrylov(const Eigen::SparseMatrix<double>& matrix, const Eigen::MatrixXd& found,
                                      double bound, uint64_t stream);

}  // namespace shoal::matching
