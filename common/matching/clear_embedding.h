// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "shoal/matching/spectrum.h"

namespace shoal::matching {

/// One component's topics as unit vectors, and the centres among them.
struct Embedding {
  std::vector<int> vertices;   ///< s, ascending
  Eigen::MatrixXd rows;        ///< s×c, each of length 1
  std::vector<int> pivots;     ///< the centres, as rows of this component
  std::vector<int> columns;    ///< and their numbers among all centres
  Eigen::VectorXd likeness;    ///< s, sum over the centres p of |u_i · u_p|
  std::vector<bool> is_pivot;  ///< s
  Eigen::MatrixXd scores;      ///< s×pivots, u_i · u_p in units of 1e-9
};

/// A topic's place in the embedding.
struct Place {
  const Embedding* embedding = nullptr;
  int row = 0;

  size_t numScores() const { return embedding->columns.size(); }
  int column(size_t k) const { return embedding->columns[k]; }
  double score(size_t k) const { return embedding->scores(row, static_cast<Eigen::Index>(k)); }
  size_t best() const;  ///< of the scores; the first of equals
};

/// CLEAR's lifting and pivots: the eigenvectors' rows at length 1, and a greedy choice of end.num_kept
/// centres among them: vertex 0, then always the topic least like those chosen, ties to the lower vertex.
/// Sums and scores are compared in whole units of 1e-9, so that round-off decides nothing.
std::vector<Embedding> embed(const SmallEnd& end);

/// The place of every vertex. Points into `embeddings`.
std::vector<Place> places(const std::vector<Embedding>& embeddings, int num_vertices);

}  // namespace shoal::matching
