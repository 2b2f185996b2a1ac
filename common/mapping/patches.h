// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "shoal/mapping/global_map.h"
#include "shoal/world/grid.h"

namespace shoal::mapping {

/// Which cells of a label count, and which of its patches are worth telling.
struct PatchFilter {
  double min_m2 = 0;  ///< smallest patch, m², >= 0
  std::optional<world::Timestamp> since =
      std::nullopt;      ///< only cells last seen at or after this mission time
  double certainty = 0;  ///< only cells at least this certain, in [0, 1]
};

/// A column of cells seen from above: cell indices x, y. Wider than a cell's, so that neighbours never
/// overflow.
using Column = std::pair<int64_t, int64_t>;

/// A connected piece of ground of one label.
struct Patch {
  std::vector<Column> columns;                                ///< ascending
  int64_t cells = 0;                                          ///< cells in these columns
  double area_m2 = 0;                                         ///< columns x cell size squared
  double x_m = 0, y_m = 0;                                    ///< centroid: the mean of the columns' centres
  double min_x_m = 0, min_y_m = 0, max_x_m = 0, max_y_m = 0;  ///< outer edges of its cells
  std::vector<world::RobotId> robots;                         ///< that saw its cells last, ascending
  world::Timestamp first_seen, last_seen;                     ///< least and greatest `seen` of its cells
  double certainty = 0;                                       ///< mean over its cells, in [0, 1]
};

/// The patches of a label: columns that touch at an edge or a corner (8 neighbours in x, y) belong together,
/// whatever their heights. Lengths in metres of the mission frame. Largest first, among equals the one with
/// the lowest column. None when no cell passes.
///
/// Cost: O(n log n) for n cells of the label.
/// @throws std::invalid_argument when `min_m2` is negative or `certainty` lies outside [0, 1].
std::vector<Patch> patchesOf(const GlobalMap& map, const world::Grid& grid, world::GlobalLabel label,
                             const PatchFilter& filter = {});

}  // namespace shoal::mapping
