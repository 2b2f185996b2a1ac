// SPDX-License-Identifier: BSD-3-Clause
#include <bit>

#include "shoal/wire/cells_coder.h"
#include "shoal/wire/range_coder.h"

namespace shoal::wire {
namespace {

constexpr int kEdge = mapping::kBrickEdge;

struct Heights {
  int lowest = kEdge, highest = -1;
};

Heights heightsOf(const Occupancy& occupancy) {
  Heights heights;
  for (int x = 0; x < kEdge; ++x) {
    for (int y = 0; y < kEdge; ++y) {
      const uint16_t column = occupancy.column(x, y);
      if (column == 0) continue;
      heights.lowest = std::min(heights.lowest, std::countr_zero(column));
      heights.highest = std::max(heights.highest, static_cast<int>(std::bit_width(column)) - 1);
    }
  }
  return heights;
}

// How far the nearest cell of a column lies above (> 4) or below (< 4) z, from 1 to 7; 0 when it is empty.
size_t stepTo(const CellField& field, int x, int y, int z) {
  const int height = field.nearestHeight(x, y, z);
  return height == CellField::kNone ? 0 : static_cast<size_t>(std::clamp(height - z, -3, 3) + 4);
}

}  // namespace

GeometryCoder::GeometryCoder()
    : alike_(64), heights_(size_t{8} * 8 * 2), diagonals_(size_t{8} * 8 * 8 * 2), mixer_(3, 2) {
  // Before anything was seen: a cell is probably as those west and south of it.
  for (size_t context = 0; context < alike_.size(); ++context) {
    constexpr std::array<uint16_t, 4> kOne = {2000, 26000, 50000, 63500};
    alike_[context] = {.one = kOne[static_cast<size_t>(std::popcount(context & 7))], .seen = 3};
  }
}

template <typename Coder>
void GeometryCoder::code(Coder& coder, const std::array<int32_t, 3>& brick, const Occupancy& occupancy,
                         CellField& field) {
  const Heights own = heightsOf(occupancy);
  const auto lowest = static_cast<int>(lowest_.code(coder, static_cast<uint32_t>(own.lowest)));
  const auto highest = static_cast<int>(highest_.code(coder, static_cast<uint32_t>(own.highest)));
  field.beginBrick(brick);
  for (int x = 0; x < kEdge; ++x) {
    for (int y = 0; y < kEdge; ++y) {
      bool has_cell = false;
      const size_t south_none = stepTo(field, x, y - 1, lowest), west_none = stepTo(field, x - 1, y, lowest);
      const bool alone = south_none == 0 && west_none == 0;  // the edge of what is known, or of what there is
      for (int z = lowest; z <= highest; ++z) {
        const size_t west = stepTo(field, x - 1, y, z), south = stepTo(field, x, y - 1, z);
        const size_t southwest = stepTo(field, x - 1, y - 1, z), northwest = stepTo(field, x - 1, y + 1, z);
        const size_t began = has_cell ? 1 : 0;
        const size_t same = (west == 4 ? 1u : 0u) | (south == 4 ? 2u : 0u) | (southwest == 4 ? 4u : 0u) |
                            (west > 4 ? 8u : 0u) | (south > 4 ? 16u : 0u) | (has_cell ? 32u : 0u);
        const std::array<ContextBit*, 3> contexts = {
            &alike_[same], &heights_[(west * 8 + south) * 2 + began],
            &diagonals_[((southwest * 8 + northwest) * 8 + west) * 2 + began]};
        if (mixer_.code(coder, contexts, alone ? 1 : 0, occupancy.at(x, y, z) ? 1 : 0) == 0) continue;
        field.add(x, y, z);
        has_cell = true;
      }
    }
  }
}

template void GeometryCoder::code(Encoder&, const std::array<int32_t, 3>&, const Occupancy&, CellField&);
template void GeometryCoder::code(Decoder&, const std::array<int32_t, 3>&, const Occupancy&, CellField&);

}  // namespace shoal::wire
