// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/SparseCore>

#include "shoal/matching/association_graph.h"
#include "shoal/matching/clustering.h"
#include "shoal/matching/pair_constraints.h"
#include "shoal/matching/spectrum_memory.h"

namespace shoal::matching {

/// Options of rectify(). All of them affect the answer, none the speed.
struct ClearOptions {
  /// Eigenvalues of the normalised Laplacian below this count as global labels.
  /// Dimensionless, in (0, 1). For a perfect cluster graph every eigenvalue is
  /// exactly 0 or 1, so 0.5 sits as far from both as it can. Jamieson §IV-D.
  double eigenvalue_threshold = 0.5;

  /// An eigenvalue this close to the threshold counts as on it, not below it.
  /// Ties at exactly 0.5 are common (two topics matched to a third but not to
  /// each other) and must not be decided by round-off.
  double eigenvalue_tolerance = 1e-6;

  /// Whether the topics of one robot stay apart. Without it edges inside a robot
  /// count, the floor on the number of labels falls away and each topic goes to
  /// its nearest centre by itself, as in the published runs of the paper.
  bool distinct = true;
};

/// The Laplacian that CLEAR analyses, (D + I)^(-1/2) (D - A) (D + I)^(-1/2).
///
/// Edges between two topics of one robot are left out of A, if `distinct`.
///
/// @returns n×n, symmetric, eigenvalues in [0, 2). For a cluster graph they are
///          exactly 0 (once per cluster) and 1.
/// @throws std::invalid_argument as rectify().
Eigen::SparseMatrix<double> normalizedLaplacian(const AssociationGraph& graph, bool distinct = true);

/// Finds the cluster graph nearest to a noisy association graph (CLEAR).
///
/// The eigenvalues of normalizedLaplacian() under the threshold count the global
/// labels (never fewer than the largest robot has topics), their eigenvectors
/// embed the topics, and each robot's topics are assigned to distinct embedded
/// centres. So no two topics of one robot share a label, unless `distinct` is off.
///
/// The result is the same for every node that calls it with the same graph: no
/// random numbers, no warm start, and ties go to the lower vertex. Callers who
/// want it independent of arrival order sort the robots first, as mapping does.
///
/// @param graph  Topics per robot (0 is legal), edges i < j with finite
///               weights >= 0, no edge twice.
/// @param constraints  vertices that must be together become one, with the
///               heaviest of the edges between; those that must be apart are
///               treated as if of one robot (constrained_clear.h).
/// @param memory  when not null: components that it knows are not solved again. Changes no answer.
/// @returns A clustering of the graph's vertices. Empty for a graph without any.
/// @throws std::invalid_argument naming the offending edge, option or pair.
///
/// Cost: O(nnz + n·m) per step of the eigensolver for components above 300 vertices,
/// O(s³) for a smaller one of s vertices; memory O(nnz + n·m). Never n×n.
///
/// Source: K. Fathian et al., "CLEAR: A Consistent Lifting, Embedding, and
/// Alignment Rectification Algorithm", IEEE T-RO 2020, arXiv:1902.02256; used
/// as in S. Jamieson et al. 2021, §IV-D. We differ from the authors' Matlab in
/// two places: the tolerance at the threshold, and optimal instead of greedy
/// assignment; see clear.cc.
Clustering rectify(const AssociationGraph& graph, const ClearOptions& options = {},
                   const PairConstraints& constraints = {}, SpectrumMemory* memory = nullptr);

}  // namespace shoal::matching
