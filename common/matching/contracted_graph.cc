// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/contracted_graph.h"

#include <algorithm>
#include <map>

namespace shoal::matching {

AssociationGraph contractedGraph(const AssociationGraph& graph, const Contraction& contraction,
                                 const Conflicts& conflicts) {
  std::map<std::pair<int, int>, double> heaviest;
  for (const Edge& e : graph.edges) {
    const auto [g, h] = std::minmax(
        {contraction.group[static_cast<size_t>(e.i)], contraction.group[static_cast<size_t>(e.j)]});
    if (g == h || conflicts.between(g, h)) continue;
    double& weight = heaviest[{g, h}];
    weight = std::max(weight, e.weight);
  }
  AssociationGraph contracted{{contraction.numGroups()}, {}};
  for (const auto& [ends, weight] : heaviest) contracted.edges.push_back({ends.first, ends.second, weight});
  return contracted;
}

}  // namespace shoal::matching
