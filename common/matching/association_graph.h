// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

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

}  // namespace shoal::matching
