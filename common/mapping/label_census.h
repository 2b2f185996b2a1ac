// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <span>

#include "shoal/mapping/global_map.h"

namespace shoal::mapping {

/// What the cells of a label add up to.
struct LabelCount {
  int64_t columns = 0;         ///< distinct (x, y) among them
  world::Timestamp last_seen;  ///< the latest among them
  int64_t certainty = 0;       ///< sum, in steps of 1 / kCertaintySteps
  int64_t sure = 0;            ///< cells whose certainty has been heard and is above 0
  bool operator==(const LabelCount&) const = default;
};

/// By label. Of a map in pieces that share no column, the sum of the pieces' is the map's.
using LabelCensus = std::map<world::GlobalLabel, LabelCount>;

/// @param cells  ascending by cell. Cost: O(cells).
LabelCensus censusOf(std::span<const GlobalCell> cells);

/// Adds the census of other columns.
void add(LabelCensus& sum, const LabelCensus& part);

}  // namespace shoal::mapping
