// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shoal/wire/numbers.h"
#include "shoal/world/ids.h"

namespace shoal::wire {

/// Which of a brick's 16 x 16 x 16 cells are there: per column (x, y), one bit per z.
class Occupancy {
 public:
  static constexpr int kEdge = 16;

  bool at(int x, int y, int z) const {
    return x >= 0 && y >= 0 && z >= 0 && x < kEdge && y < kEdge && z < kEdge && (column(x, y) >> z & 1) != 0;
  }
  void set(int x, int y, int z) {
    columns_[static_cast<size_t>(x * kEdge + y)] |= static_cast<uint16_t>(1u << z);
  }
  uint16_t column(int x, int y) const { return columns_[static_cast<size_t>(x * kEdge + y)]; }

  int numCells() const;

  /// The cells there, ascending, of the brick at these coordinates.
  std::vector<world::CellIndex> cells(const std::array<int32_t, 3>& brick) const;

  /// The inverse: every cell lies in one brick, and is taken modulo its edge.
  template <typename Cells>
  static Occupancy of(const Cells& cells) {
    Occupancy occupancy;
    for (const auto& c : cells) occupancy.set(c.cell.x & 15, c.cell.y & 15, c.cell.z & 15);
    return occupancy;
  }

 private:
  std::array<uint16_t, kEdge * kEdge> columns_{};
};

/// The bounding box (24 bits), then a bit per cell inside it, each expected to be as its neighbours in the
/// columns coded before. A flat layer costs next to nothing, a hole about its surprise.
template <typename Coder>
Occupancy codeOccupancy(Coder& coder, const Occupancy& occupancy);

/// For each cell in canonical order, up to four cells before it that probably look alike, as positions in
/// that order: below, then the nearest in height of the columns at (x, y - 1), (x - 1, y), (x - 1, y - 1),
/// (x - 1, y + 1). Where fewer exist the first is repeated; {-1, ...} where there is none.
std::vector<std::array<int16_t, 4>> neighboursOf(const Occupancy& occupancy);

/// How the values of a column of numbers relate.
enum class Scale {
  kNames,  ///< they do not: a new one costs the same whatever it is (topics, labels)
  kOrder   ///< a new one is probably close to a neighbour's (times)
};

/// One number in [0, size) per cell, expected to equal a neighbour's.
/// @returns false when a number read is out of range or the stream has ended.
template <typename Coder>
bool codeIndices(Coder& coder, std::span<const std::array<int16_t, 4>> neighbours, int32_t size, Scale scale,
                 std::vector<int32_t>& indices);

/// One level in [0, levels) per cell, expected to be near its neighbours' mean.
/// @returns false when a level read is out of range or the stream has ended.
template <typename Coder>
bool codeLevels(Coder& coder, std::span<const std::array<int16_t, 4>> neighbours, int32_t levels,
                std::vector<int32_t>& values);

/// Distinct numbers in [0, limit], ascending, at least one and at most `max_size`.
/// @returns false when what is read is none of that.
template <typename Coder>
bool codePalette(Coder& coder, int64_t limit, size_t max_size, std::vector<int64_t>& palette);

/// The same for times: divided by their greatest common divisor first, usually the period of the frames.
template <typename Coder>
bool codeTimes(Coder& coder, int64_t limit, size_t max_size, std::vector<int64_t>& times);

/// A column of numbers as a palette and an index per cell.
struct Palette {
  std::vector<int64_t> values;   ///< distinct, ascending
  std::vector<int32_t> indices;  ///< per cell

  /// Of the numbers that `value` takes from each of `cells`.
  template <typename Cells, typename Value>
  static Palette of(const Cells& cells, Value value) {
    Palette palette;
    for (const auto& cell : cells) palette.values.push_back(value(cell));
    const std::vector<int64_t> column = palette.values;
    std::sort(palette.values.begin(), palette.values.end());
    palette.values.erase(std::unique(palette.values.begin(), palette.values.end()), palette.values.end());
    for (const int64_t v : column) {
      const auto at = std::lower_bound(palette.values.begin(), palette.values.end(), v);
      palette.indices.push_back(static_cast<int32_t>(at - palette.values.begin()));
    }
    return palette;
  }
};

}  // namespace shoal::wire
