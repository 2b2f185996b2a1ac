// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <bit>

#include "shoal/wire/cells_coder.h"
#include "shoal/wire/limits.h"
#include "shoal/wire/range_coder.h"

namespace shoal::wire {
namespace {

using mapping::kBrickEdge;

size_t placesBetween(int lowest, int highest) {
  return static_cast<size_t>(std::max(highest - lowest + 1, 0)) * kBrickEdge * kBrickEdge;
}

constexpr int kNone = CellField::kNone;
constexpr size_t kSteps = 8, kTrends = 9, kStates = 3;

// How far the nearest cell of a column lies above (> 4) or below (< 4) z, from 1 to 7; 0 when it is empty.
size_t stepTo(int height, int z) {
  return height == kNone ? 0 : static_cast<size_t>(std::clamp(height - z, -3, 3) + 4);
}

// Where a line or plane through columns known comes to, seen from z: from 1 to 8, 5 is z; 0 when one is
// empty.
size_t trendTo(bool known, int height, int z) {
  return known ? static_cast<size_t>(std::clamp(height - z, -4, 3) + 5) : 0;
}

}  // namespace

std::pair<int, int> Occupancy::heights() const {
  uint16_t all = 0;
  for (const uint16_t column : columns_) all |= column;
  if (all == 0) return {kBrickEdge, -1};
  return {std::countr_zero(all), static_cast<int>(std::bit_width(all)) - 1};
}

size_t Occupancy::numPlaces() const {
  const auto [lowest, highest] = heights();
  return placesBetween(lowest, highest);
}

GeometryCoder::GeometryCoder()
    : alike_(64),
      heights_(kSteps * kSteps * kStates),
      diagonals_(kSteps * kSteps * kSteps * kStates),
      corners_(kSteps * kSteps * kSteps * kSteps * kStates),
      lines_(kSteps * kSteps * kSteps * kSteps * kStates),
      slopes_(kTrends * kTrends * kTrends * kStates),
      patterns_(size_t{4096} * kStates),
      mixer_(7, 2 * kStates) {
  // Before anything was seen: a cell is probably as those west and south of it.
  for (size_t context = 0; context < alike_.size(); ++context) {
    constexpr std::array<uint16_t, 4> kOne = {2000, 26000, 50000, 63500};
    alike_[context] = {.one = kOne[static_cast<size_t>(std::popcount(context & 7))], .seen = 3};
  }
}

template <typename Coder>
int GeometryCoder::codePlace(Coder& coder, const CellField& field, const std::array<int, 3>& place,
                             const Around& around, bool alone, bool has_cell, size_t state, int bit) {
  const auto [x, y, z] = place;
  const auto height = [&field, x = x, y = y, z = z](int dx, int dy) {
    return field.nearestHeight(x + dx, y + dy, z);
  };
  const int h_west = height(-1, 0), h_south = height(0, -1), h_southwest = height(-1, -1);
  const int h_west2 = height(-2, 0), h_south2 = height(0, -2);
  const bool knows_west = h_west != kNone, knows_south = h_south != kNone;
  const size_t plane =
      trendTo(knows_west && knows_south && h_southwest != kNone, h_west + h_south - h_southwest, z);
  const size_t eastward = trendTo(knows_west && h_west2 != kNone, 2 * h_west - h_west2, z);
  const size_t northward = trendTo(knows_south && h_south2 != kNone, 2 * h_south - h_south2, z);
  const size_t west = stepTo(h_west, z), south = stepTo(h_south, z);
  const size_t southwest = stepTo(h_southwest, z), northwest = stepTo(height(-1, 1), z);
  const size_t same = (west == 4 ? 1u : 0u) | (south == 4 ? 2u : 0u) | (southwest == 4 ? 4u : 0u) |
                      (west > 4 ? 8u : 0u) | (south > 4 ? 16u : 0u) | (has_cell ? 32u : 0u);
  size_t pattern = 0;  // are there cells right below, at and right above z?
  for (size_t k = 0; k < around.size(); ++k) pattern |= (around[k] >> z & 7) << (3 * k);
  const size_t both = west * kSteps + south;
  const size_t diagonal = southwest * kSteps + northwest;
  const size_t second = stepTo(h_west2, z) * kSteps + stepTo(h_south2, z);
  const std::array<ContextBit*, 7> contexts = {
      &alike_[same],
      &heights_[both * kStates + state],
      &diagonals_[(diagonal * kSteps + west) * kStates + state],
      &corners_[(both * kSteps * kSteps + diagonal) * kStates + state],
      &lines_[(both * kSteps * kSteps + second) * kStates + state],
      &slopes_[((plane * kTrends + eastward) * kTrends + northward) * kStates + state],
      &patterns_[pattern * kStates + state]};
  return mixer_.code(coder, contexts, (alone ? kStates : 0) + state, bit);
}

template <typename Coder>
bool GeometryCoder::code(Coder& coder, const std::array<int32_t, 3>& brick, const Occupancy& occupancy,
                         CellField& field) {
  const auto [own_lowest, own_highest] = occupancy.heights();
  const auto lowest = static_cast<int>(lowest_.code(coder, static_cast<uint32_t>(own_lowest)));
  const auto highest = static_cast<int>(highest_.code(coder, static_cast<uint32_t>(own_highest)));
  places_ += placesBetween(lowest, highest);
  if (places_ > kMaxPlacesPerMessage) return false;
  field.beginBrick(brick);
  for (int x = 0; x < kBrickEdge; ++x) {
    for (int y = 0; y < kBrickEdge; ++y) {
      // The edge of what is known, or of what there is.
      const bool alone =
          field.nearestHeight(x, y - 1, lowest) == kNone && field.nearestHeight(x - 1, y, lowest) == kNone;
      const Around around = {field.heights(x - 1, y), field.heights(x, y - 1), field.heights(x - 1, y - 1),
                             field.heights(x - 1, y + 1)};
      bool has_cell = false;
      size_t state = field.at(x, y, lowest - 1) ? 1 : 0;  // 1: right above a cell, 2: above a gap, 0: neither
      for (int z = lowest; z <= highest; ++z) {
        const int bit = occupancy.at(x, y, z) ? 1 : 0;
        if (codePlace(coder, field, {x, y, z}, around, alone, has_cell, state, bit) != 0) {
          field.add(x, y, z);
          has_cell = true;
          state = 1;
        } else if (state == 1) {
          state = 2;
        }
      }
    }
  }
  return true;
}

template bool GeometryCoder::code(Encoder&, const std::array<int32_t, 3>&, const Occupancy&, CellField&);
template bool GeometryCoder::code(Decoder&, const std::array<int32_t, 3>&, const Occupancy&, CellField&);

}  // namespace shoal::wire
