// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/connected_components.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace shoal::matching {

Clustering matchByComponents(const AssociationGraph& graph) {
  check(graph);
  std::vector<int> parent(static_cast<size_t>(graph.numVertices()));  // of a forest whose roots are lowest
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int v) {
    auto at = static_cast<size_t>(v);
    while (parent[at] != static_cast<int>(at)) {
      parent[at] = parent[static_cast<size_t>(parent[at])];
      at = static_cast<size_t>(parent[at]);
    }
    return static_cast<int>(at);
  };
  for (const Edge& e : graph.edges) {
    if (e.weight == 0.0) continue;
    const auto [low, high] = std::minmax({root(e.i), root(e.j)});
    parent[static_cast<size_t>(high)] = low;
  }
  std::vector<int> label;
  int num_components = 0;
  for (int v = 0; v < graph.numVertices(); ++v) {
    label.push_back(root(v));
    num_components += label.back() == v;
  }
  return numberByFirstAppearance(label, num_components);
}

}  // namespace shoal::matching
