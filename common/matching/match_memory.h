// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "shoal/matching/neighbour_memory.h"
#include "shoal/matching/spectrum_memory.h"

namespace shoal::matching {

/// What one matching leaves for the next: which topics are alike, and the eigenpairs of the graph's
/// components. All of it is known by content, so that match() answers the same with any memory, to the byte,
/// and without. It may be handed to matchings of other topics and options.
struct MatchMemory {
  NeighbourMemory neighbours;
  SpectrumMemory spectra;
};

}  // namespace shoal::matching
