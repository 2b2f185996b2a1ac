// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "shoal/matching/association_graph.h"
#include "shoal/matching/clustering.h"
#include "shoal/matching/pair_constraints.h"

namespace shoal::matching {

/// Takes what a chain of edges joins for the same: the connected components of the graph. The simplest use of
/// a graph, and what one wrong edge can do to it is why CLEAR exists. Two topics of one robot share a label
/// when a chain joins them. An edge of weight 0 joins nothing.
///
/// What must be together is joined like by an edge. Of what must be apart and is joined by a chain all the
/// same, the later one gets a label of its own, with those it must be together with.
///
/// @throws std::invalid_argument as check(graph), and naming a pair of vertices that are none or that must be
/// both together and apart. Cost: O(edges); O(edges log edges) under constraints.
Clustering matchByComponents(const AssociationGraph& graph, const PairConstraints& constraints = {});

}  // namespace shoal::matching
