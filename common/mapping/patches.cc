// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/patches.h"

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <stdexcept>
#include <string>

namespace shoal::mapping {
namespace {

using CellsByColumn = std::map<Column, std::vector<const GlobalCell*>>;

// The columns connected with `start`, ascending; they are taken out of `open`.
std::vector<Column> takeConnected(std::set<Column>& open, const Column& start) {
  std::vector<Column> patch = {start};
  open.erase(start);
  for (size_t next = 0; next < patch.size(); ++next) {
    const auto [x, y] = patch[next];
    for (int64_t dx = -1; dx <= 1; ++dx) {
      for (int64_t dy = -1; dy <= 1; ++dy) {
        if (open.erase({x + dx, y + dy}) > 0) patch.emplace_back(x + dx, y + dy);
      }
    }
  }
  std::ranges::sort(patch);
  return patch;
}

Patch measure(std::vector<Column> columns, const CellsByColumn& cells, double cell_size_m) {
  Patch patch;
  patch.columns = std::move(columns);
  const auto [first, last] = patch.columns.front();
  patch.first_seen = patch.last_seen = cells.at({first, last}).front()->seen;
  int64_t sum_x = 0, sum_y = 0;
  int64_t min_y = last, max_y = last;
  std::set<world::RobotId> robots;
  for (const Column& column : patch.columns) {
    sum_x += column.first;
    sum_y += column.second;
    min_y = std::min(min_y, column.second);
    max_y = std::max(max_y, column.second);
    for (const GlobalCell* cell : cells.at(column)) {
      ++patch.cells;
      patch.certainty += static_cast<double>(cell->certainty);
      patch.first_seen = std::min(patch.first_seen, cell->seen);
      patch.last_seen = std::max(patch.last_seen, cell->seen);
      robots.insert(cell->robot);
    }
  }
  const auto num_columns = static_cast<double>(patch.columns.size());
  patch.area_m2 = num_columns * cell_size_m * cell_size_m;
  patch.x_m = static_cast<double>(sum_x) / num_columns * cell_size_m;
  patch.y_m = static_cast<double>(sum_y) / num_columns * cell_size_m;
  patch.min_x_m = (static_cast<double>(first) - 0.5) * cell_size_m;
  patch.max_x_m = (static_cast<double>(patch.columns.back().first) + 0.5) * cell_size_m;
  patch.min_y_m = (static_cast<double>(min_y) - 0.5) * cell_size_m;
  patch.max_y_m = (static_cast<double>(max_y) + 0.5) * cell_size_m;
  patch.certainty /= static_cast<double>(patch.cells);
  patch.robots.assign(robots.begin(), robots.end());
  return patch;
}

}  // namespace

std::vector<Patch> patchesOf(const GlobalMap& map, const world::Grid& grid, world::GlobalLabel label,
                             const PatchFilter& filter) {
  if (!(filter.min_m2 >= 0)) {
    throw std::invalid_argument("the smallest patch must be 0 m2 or more, got " +
                                std::to_string(filter.min_m2));
  }
  if (!(filter.certainty >= 0 && filter.certainty <= 1)) {
    throw std::invalid_argument("certainty must lie in [0, 1], got " + std::to_string(filter.certainty));
  }
  CellsByColumn cells;
  std::set<Column> open;
  for (const GlobalCell& c : map.cells) {
    if (c.label != label || static_cast<double>(c.certainty) < filter.certainty) continue;
    if (filter.since && c.seen < *filter.since) continue;
    cells[{c.cell.x, c.cell.y}].push_back(&c);
    open.emplace(c.cell.x, c.cell.y);
  }
  std::vector<Patch> patches;
  while (!open.empty()) {
    Patch patch = measure(takeConnected(open, *open.begin()), cells, grid.cellSize());
    if (patch.area_m2 >= filter.min_m2) patches.push_back(std::move(patch));
  }
  std::ranges::stable_sort(patches, std::greater<>(), [](const Patch& p) { return p.columns.size(); });
  return patches;
}

}  // namespace shoal::mapping
