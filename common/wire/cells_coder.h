// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "shoal/wire/bit_mixer.h"
#include "shoal/wire/cell_field.h"
#include "shoal/wire/context_table.h"
#include "shoal/wire/numbers.h"
#include "shoal/world/ids.h"

namespace shoal::wire {

/// Which cells of a brick are there: per column (x, y), one bit per z.
class Occupancy {
 public:
  bool at(int x, int y, int z) const { return (column(x, y) >> z & 1) != 0; }
  void set(int x, int y, int z) { columns_[index(x, y)] |= static_cast<uint16_t>(1u << z); }
  uint16_t column(int x, int y) const { return columns_[index(x, y)]; }

  /// The lowest and the highest z of its cells; (16, -1) without any.
  std::pair<int, int> heights() const;

  /// How many places are asked about, is there a cell? All that are no lower or higher than its cells.
  size_t numPlaces() const;

  /// Every cell lies in one brick, and is taken modulo its edge.
  template <typename Cells>
  static Occupancy of(const Cells& cells) {
    Occupancy occupancy;
    for (const auto& c : cells) occupancy.set(c.cell.x & 15, c.cell.y & 15, c.cell.z & 15);
    return occupancy;
  }

 private:
  static size_t index(int x, int y) { return static_cast<size_t>(x * mapping::kBrickEdge + y); }
  std::array<uint16_t, size_t{mapping::kBrickEdge} * mapping::kBrickEdge> columns_{};
};

/// Says which cells are there, brick by brick: the heights between which all of a brick's cells lie, then a
/// bit for each place between them, expected to be as in the columns known already, or where lines and a
/// plane through them lead. A flat layer costs next to nothing, a hole about its surprise.
class GeometryCoder {
 public:
  GeometryCoder();

  /// Adds the cells of one more brick to `field`. When reading, `occupancy` is not looked at.
  /// @returns false, before any of its places is coded, when those of all bricks are more than
  /// kMaxPlacesPerMessage.
  template <typename Coder>
  [[nodiscard]] bool code(Coder& coder, const std::array<int32_t, 3>& brick, const Occupancy& occupancy,
                          CellField& field);

 private:
  using Around = std::array<uint32_t, 4>;  // CellField::heights() of four columns

  // Is there a cell at `place` of the brick begun?
  template <typename Coder>
  int codePlace(Coder& coder, const CellField& field, const std::array<int, 3>& place, const Around& around,
                bool alone, bool has_cell, size_t state, int bit);

  size_t places_ = 0;  // asked about so far
  BitTree lowest_{4}, highest_{4};
  std::vector<ContextBit> alike_;
  ContextTable heights_, diagonals_, corners_, lines_, slopes_, patterns_;
  BitMixer mixer_;
};

/// How the values of a column of numbers relate.
enum class Scale {
  kNames,  ///< they do not: a new one is one of the frequent ones (topics, labels, certainties)
  kOrder   ///< a new one is probably close to a neighbour's (times)
};

/// One number in [0, size) per cell, expected to equal a neighbour's.
/// @returns false when a number read is out of range or the stream has ended.
template <typename Coder>
bool codeIndices(Coder& coder, const CellField& field, int32_t size, Scale scale,
                 std::vector<int32_t>& indices);

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

  /// Of a column of numbers.
  static Palette of(std::vector<int64_t> column) {
    Palette palette;
    palette.values = column;
    std::sort(palette.values.begin(), palette.values.end());
    palette.values.erase(std::unique(palette.values.begin(), palette.values.end()), palette.values.end());
    for (const int64_t v : column) {
      const auto at = std::lower_bound(palette.values.begin(), palette.values.end(), v);
      palette.indices.push_back(static_cast<int32_t>(at - palette.values.begin()));
    }
    return palette;
  }

  /// Of the numbers that `value` takes from each of `cells`.
  template <typename Cells, typename Value>
  static Palette of(const Cells& cells, Value value) {
    std::vector<int64_t> column;
    for (const auto& cell : cells) column.push_back(value(cell));
    return of(std::move(column));
  }

  int32_t size() const { return static_cast<int32_t>(values.size()); }
  int64_t at(size_t cell) const { return values[static_cast<size_t>(indices[cell])]; }
};

}  // namespace shoal::wire
