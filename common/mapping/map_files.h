// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "shoal/mapping/global_map.h"
#include "shoal/mapping/label_census.h"
#include "shoal/world/grid.h"

namespace shoal::mapping {

/// Ground that each label covers: distinct (x, y) columns of cells x cell size squared, m².
std::map<world::GlobalLabel, double> areas(const GlobalMap& map, const world::Grid& grid);
std::map<world::GlobalLabel, double> areasOf(const LabelCensus& census, const world::Grid& grid);

/// The map as CSV: x_m,y_m,z_m,label,robot,seen_s,certainty; a row a cell, ascending by cell index.
std::string globalMapCsv(const GlobalMap& map, const world::Grid& grid);

/// The legend as CSV: label,name,cells,area_m2,robots,first_seen_s; ascending by label.
std::string labelsCsv(const GlobalMap& map, const world::Grid& grid);
std::string labelsCsv(const std::vector<LabelSummary>& labels,
                      const std::map<world::GlobalLabel, double>& areas);

/// Reads both texts back, as readGlobalMap() does; `origin` is named in errors.
GlobalMap parseGlobalMap(const std::string& cells_csv, const std::string& labels_csv, const world::Grid& grid,
                         const std::string& origin);

/// Reads both back (cells and labels; correspondences and digests are not in the files). Times come back to
/// the millisecond, certainties in steps of 1/63 exactly. @throws std::runtime_error naming the file and what
/// is wrong.
GlobalMap readGlobalMap(const std::string& folder, const world::Grid& grid);

}  // namespace shoal::mapping
