// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "shoal/mapping/patches.h"

namespace shoal::mapping {

/// A corner of cells: (i, j) lies at ((i - 1/2), (j - 1/2)) x cell size, the low corner of column (i, j).
using Corner = std::pair<int64_t, int64_t>;

/// A closed way along cell edges that touches no corner twice; only corners where it turns, the first not
/// repeated.
using Ring = std::vector<Corner>;

/// One outer ring, counter-clockwise seen from above, and its holes, clockwise (RFC 7946 section 3.1.6).
struct Polygon {
  Ring outer;
  std::vector<Ring> holes;
};

/// The exact outline of a set of columns. Columns that share an edge share a polygon; polygons that meet at
/// a corner only stay apart, and so do holes: every polygon is valid in the sense of OGC Simple Features.
/// Equal sets, equal outline: polygons ascend by their lowest column, rings start at their lowest corner.
///
/// @param columns  ascending, each once.
/// Cost: O(n log n).
std::vector<Polygon> outlineOf(std::span<const Column> columns);

}  // namespace shoal::mapping
