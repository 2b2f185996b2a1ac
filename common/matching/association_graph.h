// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

#include "shoal/matching/descriptors.h"
#include "shoal/matching/discounted_similarity.h"
#include "shoal/matching/neighbour_memory.h"
#include "shoal/matching/similarity.h"

namespace shoal::matching {

/// "These two topics look alike", i < j.
struct Edge {
  int i = 0;
  int j = 0;
  double weight = 1.0;  ///< >= 0, finite
};

/// The vertices are the topics of all robots, robot after robot; edges join topics that may be the same.
struct AssociationGraph {
  std::vector<int> num_topics;  ///< topics of each robot; 0 is legal
  std::vector<Edge> edges;      ///< i < j, no edge twice

  int numVertices() const { return std::accumulate(num_topics.begin(), num_topics.end(), 0); }
};

/// @throws std::invalid_argument naming what is no association graph: a negative count, an edge that is not
/// i < j within the vertices, a weight that is negative or not finite, an edge that is there twice.
void check(const AssociationGraph& graph);

/// The robot of every vertex.
std::vector<int> owners(const AssociationGraph& graph);

/// Joins the topics of different robots that are at least `sigma` alike (edges of weight 1), and with
/// `own_pairs` those of one robot as well. Empty topics get no edges.
///
/// @param topics  valid: check(topics) has passed.
/// @param sigma   in (0, 1].
///
/// @param memory  when not null: saves what was compared for the next graph (neighbour_memory.h).
///
/// Cost: O(n² V) for n topics of V words; cosine() by cosineNeighbours(), for sparse ones a fraction of it.
AssociationGraph associationGraph(const DescriptorSet& topics, Similarity similarity, double sigma,
                                  bool own_pairs = false, NeighbourMemory* memory = nullptr);

/// The same with similarities already known, by vertex.
AssociationGraph associationGraph(const DescriptorSet& topics, const PairTable& similarity, double sigma,
                                  bool own_pairs = false);

}  // namespace shoal::matching
