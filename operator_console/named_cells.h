// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "shoal/mapping/queries.h"

namespace shoal::console {

/// Cells of a map for a person to name, as CSV: x_m,y_m,z_m,robot,seen_s,name, the last one empty; drawn at
/// random without replacement, each cell as likely as any other, ascending by cell. The map's labels are left
/// out: who does not know them cannot be swayed.
/// @param count  >= 1; all cells where there are fewer.
/// @param seed   another one, other cells; the same for the same map.
std::string cellsToName(const mapping::MissionView& view, int64_t count, uint64_t seed);

/// A cell and what a person says that it is.
struct NamedCell {
  world::CellIndex cell;
  std::string name;
};

/// What a person made of cellsToName().
struct NamedCells {
  std::vector<NamedCell> cells;  ///< in the order of the file
  int64_t unnamed = 0;           ///< rows without a name
};

/// @param path  for messages.
/// @throws std::runtime_error naming the path and the line: another header, what is no number or out of
/// reach,
///         a cell that is named twice.
NamedCells parseNamedCells(const std::string& csv, const world::Grid& grid, const std::string& path);

/// The score of the map by the cells that were named: {"cells", "named", "unnamed", "off_map", "labels",
/// "names", "ami", "low", "high", "by_label": [{"label", "name", "named", "most_often", "share"}]}, the
/// labels with most named cells first. "off_map" were named and are no longer on the map.
/// @throws std::invalid_argument for fewer than eval::kFewestNamedCells on the map.
nlohmann::ordered_json namedScore(const mapping::MissionView& view, const NamedCells& named);

}  // namespace shoal::console
