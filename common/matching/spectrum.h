// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "shoal/matching/spectrum_memory.h"

namespace shoal::matching {

/// The small end of the spectrum of one connected component.
struct ComponentSpectrum {
  std::vector<int> vertices;     ///< s of them, ascending
  Eigen::VectorXd eigenvalues;   ///< c >= 1, ascending; the first is 0
  Eigen::MatrixXd eigenvectors;  ///< s×c, orthonormal columns
};

/// The small end of the spectrum of a graph: the union over its components.
struct SmallEnd {
  std::vector<ComponentSpectrum> components;  ///< by lowest vertex
  int num_below = 0;                          ///< eigenvalues below the bound, counted with multiplicity
  int num_kept = 0;                           ///< eigenpairs kept in all components, max(num_below, at_least)
};

/// The eigenpairs of a normalised Laplacian below `bound`, and as many more, the smallest first, as make
/// `at_least`.
///
/// Where the cut to `at_least` falls among equal eigenvalues (within 1e-9), components with lower vertices
/// come first, and within a component the eigenspace gets the basis that Gram-Schmidt makes of the
/// projections of its lowest vertices. So the answer does not depend on the basis an eigensolver happens to
/// return.
///
/// @param laplacian  n×n, from normalizedLaplacian().
/// @param bound      > 0. The eigenvalue 0 of each component counts as below whatever round-off says.
/// @param at_least   <= n.
/// @param memory     when not null: components that it knows are not solved again.
///
/// Cost: O(s³) for a component of s <= 300 vertices, two to four products with the Laplacian a pair above;
/// cliques of unit weight and single vertices by closed form. Memory O(nnz + Σ s·c). Never n×n.
SmallEnd smallEnd(const Eigen::SparseMatrix<double>& laplacian, double bound, int at_least,
                  SpectrumMemory* memory = nullptr);

/// The vertex sets of the connected components of a symmetric matrix, by lowest vertex, each ascending. Every
/// stored entry joins.
std::vector<std::vector<int>> connectedComponents(const Eigen::SparseMatrix<double>& matrix);

}  // namespace shoal::matching
