// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/neighborhood.h"

#include <algorithm>
#include <limits>

#include "shoal/demand.h"

namespace shoal::topics {
namespace {

// One step along an axis, or the cell itself where the axis ends.
int32_t step(int32_t coordinate, int32_t direction) {
  const int64_t next = int64_t{coordinate} + direction;
  const bool inside =
      next >= std::numeric_limits<int32_t>::min() && next <= std::numeric_limits<int32_t>::max();
  return inside ? static_cast<int32_t>(next) : coordinate;
}

}  // namespace

int32_t Neighborhood::insert(const world::CellIndex& cell) {
  Cube& cube = cubes_[cubeOf(cell)];
  const auto at = std::ranges::lower_bound(cube, placeOf(cell), {}, &Numbered::place);
  if (at != cube.end() && at->place == placeOf(cell)) return at->number;
  const int32_t number = size();
  cube.insert(at, {placeOf(cell), number});
  links_.push_back({});
  for (const int32_t other : around(cell)) {
    if (other == number) continue;
    link(number, other);
    link(other, number);
  }
  return number;
}

std::optional<int32_t> Neighborhood::find(const world::CellIndex& cell) const {
  const auto cube = cubes_.find(cubeOf(cell));
  if (cube == cubes_.end()) return std::nullopt;
  const auto at = std::ranges::lower_bound(cube->second, placeOf(cell), {}, &Numbered::place);
  if (at == cube->second.end() || at->place != placeOf(cell)) return std::nullopt;
  return at->number;
}

std::vector<int32_t> Neighborhood::around(const world::CellIndex& cell) const {
  std::vector<int32_t> known;
  const auto add = [&](const world::CellIndex& other) {
    if (const auto number = find(other)) known.push_back(*number);
  };
  add(cell);
  for (const int32_t direction : {-1, 1}) {
    for (const world::CellIndex& other : {world::CellIndex{step(cell.x, direction), cell.y, cell.z},
                                          world::CellIndex{cell.x, step(cell.y, direction), cell.z},
                                          world::CellIndex{cell.x, cell.y, step(cell.z, direction)}}) {
      if (other != cell) add(other);
    }
  }
  return known;
}

bool Neighborhood::adjoin(int32_t a, int32_t b) const { return std::ranges::find(of(a), b) != of(a).end(); }

void Neighborhood::link(int32_t a, int32_t b) {
  Links& links = links_[static_cast<size_t>(a)];
  SHOAL_DEMAND(links.count < 6);
  links.cells[static_cast<size_t>(links.count++)] = b;
}

}  // namespace shoal::topics
