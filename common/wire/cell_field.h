// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "shoal/mapping/piece.h"
#include "shoal/world/ids.h"

namespace shoal::wire {

/// Columns (x, y) in whose cells a cell looks for its like, nearest first: those that an order by bricks, and
/// by x, y, z inside a brick, can have put before it.
struct NearColumn {
  int8_t dx, dy;
  int8_t weight;  ///< of its vote: falls with distance
};
inline constexpr std::array<NearColumn, 18> kNearColumns = {{{-1, 0, 16},
                                                             {0, -1, 16},
                                                             {-1, -1, 9},
                                                             {-1, 1, 9},
                                                             {1, -1, 9},
                                                             {-2, 0, 5},
                                                             {0, -2, 5},
                                                             {-2, -1, 4},
                                                             {-1, -2, 4},
                                                             {-2, 1, 4},
                                                             {-1, 2, 4},
                                                             {1, -2, 4},
                                                             {2, -1, 4},
                                                             {-2, -2, 3},
                                                             {-2, 2, 3},
                                                             {2, -2, 3},
                                                             {-3, 0, 2},
                                                             {0, -3, 2}}};

/// The cell below comes after those of the columns.
inline constexpr size_t kNumNear = kNearColumns.size() + 1;
inline constexpr int kBelowWeight = 16;

/// Places of the cells near one, in the order in which they were added; -1 where there is none.
using NearCells = std::array<int32_t, kNumNear>;

/// The cells of a message in the order in which they are coded, brick after brick: what is known of a cell's
/// surroundings when its turn comes. Bricks are added in ascending order, the cells of a brick too.
class CellField {
 public:
  /// What is added from now on lies in this brick.
  void beginBrick(const std::array<int32_t, 3>& brick);

  /// The next cell of the brick, by its place inside it.
  void add(int x, int y, int z);

  /// Whether a cell is there, as far as known. `x`, `y` in [-3, 18], relative to the brick begun, as is z.
  bool at(int x, int y, int z) const;

  /// The height of the known cell of a column that is nearest to z, the lower of two; kNone when it is empty.
  int nearestHeight(int x, int y, int z) const;
  static constexpr int kNone = 1 << 20;

  /// Which cells of a column are known, from one below the brick begun (bit 0) to one above it (bit 17).
  uint32_t heights(int x, int y) const;

  const std::vector<world::CellIndex>& cells() const { return cells_; }
  const std::vector<NearCells>& near() const { return near_; }

  /// How a cell lies among those around it.
  struct Shape {
    uint8_t west = 0, south = 0;   ///< height of the nearest cell there, seen from this one: -2 to 2, plus 3;
                                   ///< 0: none was known
    uint8_t above = 0, below = 0;  ///< cells in its column, at most 2
  };
  /// Of all cells, in their order. Cost: O(cells).
  std::vector<Shape> shapes() const;

 private:
  // The columns of all bricks one above the other: place of the last cell added, -1 for none.
  using Tile = std::array<int32_t, size_t{mapping::kBrickEdge} * mapping::kBrickEdge>;
  int32_t lastOf(int x, int y) const;
  int32_t nearest(int x, int y, int32_t z) const;

  std::map<std::pair<int32_t, int32_t>, std::unique_ptr<Tile>> tiles_;
  std::array<Tile*, 9> around_{};  // of the brick begun, by 3 (y + 1) + x + 1
  std::array<int32_t, 3> brick_{};
  std::vector<world::CellIndex> cells_;
  std::vector<int32_t> below_;  // per cell the one before it in its column, -1 for none
  std::vector<NearCells> near_;
};

}  // namespace shoal::wire
