// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/connected_components.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "shoal/matching/contracted_graph.h"

namespace shoal::matching {

Clustering matchByComponents(const AssociationGraph& graph, const PairConstraints& constraints) {
  check(graph);
  if (!constraints.empty()) {
    const Contraction contraction = contract(graph.numVertices(), constraints);
    const Clustering joined = matchByComponents(contractedGraph(graph, contraction, {contraction, {}}));
    std::vector<int> label;
    for (const int group : contraction.group) label.push_back(joined.label[static_cast<size_t>(group)]);
    return repair(contraction, {label, joined.num_labels, joined.universe}, {});
  }
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
