// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "shoal/world/ids.h"

namespace shoal::topics {

/// Which cells adjoin: the faces of a cube, at most 6, no diagonals; time is one bin (static world).
///
/// Cells are numbered in order of creation, which is order of first sight; numbers never change. Links go
/// both ways as soon as both cells exist. Constant time per cell, whatever the size of the map.
///
/// Source: ROST's von Neumann neighbourhood with depth G = 1, as in S. Jamieson et al. 2021.
class Neighborhood {
 public:
  /// Number of the cell, created and linked if it is new.
  int32_t insert(const world::CellIndex& cell);

  /// Number of a known cell; nothing for another.
  std::optional<int32_t> find(const world::CellIndex& cell) const;

  /// Numbers of the known ones among a cell, itself known or not, and those that adjoin it.
  std::vector<int32_t> around(const world::CellIndex& cell) const;

  int32_t size() const { return static_cast<int32_t>(links_.size()); }

  /// Numbers of the adjoining cells, in order of their creation or the cell's own, whichever came later.
  std::span<const int32_t> of(int32_t cell) const {
    const Links& links = links_[static_cast<size_t>(cell)];
    return {links.cells.data(), static_cast<size_t>(links.count)};
  }

  /// of() the cell will be asked for soon.
  void prefetch(int32_t cell) const { __builtin_prefetch(&links_[static_cast<size_t>(cell)]); }

  /// Do two cells adjoin? Not a cell and itself.
  bool adjoin(int32_t a, int32_t b) const;

 private:
  struct alignas(32) Links {  // in one line of the cache
    std::array<int32_t, 6> cells;
    int32_t count = 0;
  };
  // 16 x 16 x 16 cells: the table of these stays small, so that it never takes long to grow.
  struct Numbered {
    uint16_t place = 0;  // in the cube
    int32_t number = 0;
  };
  using Cube = std::vector<Numbered>;  // ascending by place

  static world::CellIndex cubeOf(const world::CellIndex& c) { return {c.x >> 4, c.y >> 4, c.z >> 4}; }
  static uint16_t placeOf(const world::CellIndex& c) {
    return static_cast<uint16_t>((c.x & 15) << 8 | (c.y & 15) << 4 | (c.z & 15));
  }
  void link(int32_t a, int32_t b);

  std::unordered_map<world::CellIndex, Cube, world::CellHash> cubes_;  // looked up, never iterated
  std::deque<Links> links_;
};

}  // namespace shoal::topics
