// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "shoal/matching/clear.h"

namespace shoal::matching {

/// rectify() under an operator's constraints, honoured exactly.
///
/// Vertices that must be together are one vertex of all their robots; of parallel edges the heaviest counts.
/// Vertices that must be apart have no edge, as two of one robot have none. The floor on the number of labels
/// is the most vertices that a robot has left. Robots choose their centres one after the other: a vertex
/// finds those taken that a vertex it must be apart from has chosen, and where none that it has anything in
/// common with is free it gets a label of its own, beside CLEAR's. A robot's own topics that an operator
/// links share a label, `distinct` or not.
///
/// @throws std::invalid_argument as rectify(), and naming a pair of vertices that are none or that must be
/// both together and apart.
Clustering rectifyConstrained(const AssociationGraph& graph, const ClearOptions& options,
                              const PairConstraints& constraints, SpectrumMemory* memory);

}  // namespace shoal::matching
