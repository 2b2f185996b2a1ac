// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "shoal/matching/association_graph.h"
#include "shoal/matching/clustering.h"

namespace shoal::matching {

/// Takes what a chain of edges joins for the same: the connected components of the graph. The simplest use of
/// a graph, and what one wrong edge can do to it is why CLEAR exists. Two topics of one robot share a label
/// when a chain joins them. An edge of weight 0 joins nothing.
///
/// @throws std::invalid_argument as check(graph). Cost: O(edges).
Clustering matchByComponents(const AssociationGraph& graph);

}  // namespace shoal::matching
