// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "shoal/matching/clear.h"

namespace shoal::matching {

/// I - L of an association graph: the matrix whose eigenvalues above one half CLEAR counts.
inline Eigen::SparseMatrix<double> complement(const AssociationGraph& graph) {
  Eigen::SparseMatrix<double> matrix = -normalizedLaplacian(graph);
  for (Eigen::Index v = 0; v < matrix.rows(); ++v) matrix.coeffRef(v, v) += 1.0;
  return matrix;
}

/// The same for a graph in which every vertex is a robot of its own.
inline Eigen::SparseMatrix<double> complement(int num_vertices, const std::vector<Edge>& edges) {
  return complement(AssociationGraph{std::vector<int>(static_cast<size_t>(num_vertices), 1), edges});
}

/// All pairs among `size` vertices from `first` on.
inline std::vector<Edge> clique(int first, int size) {
  std::vector<Edge> edges;
  for (int i = first; i < first + size; ++i) {
    for (int j = i + 1; j < first + size; ++j) edges.push_back({i, j});
  }
  return edges;
}

/// Vertex 0 joined to all others.
inline std::vector<Edge> star(int num_vertices) {
  std::vector<Edge> edges;
  for (int leaf = 1; leaf < num_vertices; ++leaf) edges.push_back({0, leaf});
  return edges;
}

/// Twelve cliques of six, each hanging on vertex 0 by one edge: 73 vertices. An eigenvalue above one half
/// occurs eleven times.
inline std::vector<Edge> twelveCliquesOnAHub() {
  std::vector<Edge> edges;
  for (int c = 0; c < 12; ++c) {
    const int first = 1 + 6 * c;
    for (const Edge& e : clique(first, 6)) edges.push_back(e);
    edges.push_back({0, first});
  }
  return edges;
}

}  // namespace shoal::matching
