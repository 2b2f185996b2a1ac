// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace shoal::matching {

/// What is known about the eigenvalues of a matrix besides those found.
enum class Rest {
  kBelow,      ///< none reaches the bound
  kAbove,      ///< one lies above it
  kUndecided,  ///< the steps allowed did not tell
};

/// Does a symmetric matrix have eigenvalues >= `bound` besides those of an invariant subspace already found?
///
/// Eight Lanczos recurrences, each from a vector x uniform in the cube [-½, ½]^s, on the complement of
/// `found`. A unit eigenvector u with eigenvalue λ has u'q_k = p_k(λ) u'q_0 in the k-th Lanczos vector q_k,
/// p_k being the orthonormal polynomials of the recurrence. As |u'q_k| <= 1, and as p_k grows beyond its last
/// root, |u'x| <= |x| / p_k(bound) for every λ >= bound. But u'x has a density of at most √2 (Ball's cube
/// slicing), so that a share so small is unlikely: 2√2 |x| / p_k(bound) for one vector, the product for
/// eight. kBelow is said when that chance is at most 1e-12 over the vectors, which are pseudo-random and
/// fixed: the answer is the same on every call. The argument does not need the q_k to be orthogonal, so the
/// loss of orthogonality that Lanczos is known for does no harm. kAbove is certain: a root of p_k at or above
/// the bound is a Ritz value, and eigenvalues interlace.
///
/// @param matrix   s×s, symmetric, compressed, eigenvalues in [-1, 1].
/// @param found    s×c, orthonormal, invariant to about 1e-11.
/// @param bound    in (0, 1].
/// @param steps    at most so many products.
/// Cost: a product of eight vectors with `matrix` and O(s·c) a step; three to ten steps when the rest lies
/// well below the bound, thousands when something lies within 1e-6 of it.
/// Source: K. Ball, Cube slicing in R^n, Proc. AMS 97, 1986.
Rest restOfSpectrum(const Eigen::SparseMatrix<double>& matrix, const Eigen::MatrixXd& found, double bound,
                    int steps = 3000);

}  // namespace shoal::matching
