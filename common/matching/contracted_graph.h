// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "shoal/matching/association_graph.h"
#include "shoal/matching/pair_constraints.h"

namespace shoal::matching {

/// The graph whose vertices are the groups, all as if of one robot. Of parallel edges the heaviest stays;
/// between groups that are in conflict none does.
/// @param graph  valid: check(graph) has passed. Cost: O(edges log edges).
AssociationGraph contractedGraph(const AssociationGraph& graph, const Contraction& contraction,
                                 const Conflicts& conflicts);

}  // namespace shoal::matching
