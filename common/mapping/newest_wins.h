// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace shoal::mapping {

/// Cells of the fused map lie in tiles of 16 x 16 at one height.
inline constexpr int32_t kTileEdge = 16;
inline constexpr size_t kTileCells = kTileEdge * kTileEdge;

/// What is shown of every cell of a tile, value by value. A cell's place is (x mod 16) x 16 + y mod 16.
struct alignas(64) TileColumns {
  std::array<uint16_t, kTileCells> time{};      ///< rank of when it was seen, from 1; 0 = nothing is said
  std::array<uint16_t, kTileCells> voice{};     ///< which robot's topic says it; 0 where nothing is said
  std::array<uint8_t, kTileCells> certainty{};  ///< in steps of 1 / kCertaintySteps
};

/// What one robot says of sixteen cells of one x, in the same terms: as many as are compared at once.
struct TileRow {
  std::array<uint16_t, kTileEdge> time{};
  std::array<uint16_t, kTileEdge> voice{};
  std::array<uint8_t, kTileEdge> certainty{};
};

/// Lets what is said into `newest` wherever it is as new or newer. Robots are taken in ascending order, so
/// that of equally new ones the higher number stays.
/// @param said   the rows of `rows`, ascending.
/// @param rows   bit r: row r.
/// @param shown  the rows of `newest` that show something; others hold anything, and become what is said.
/// @returns shown and rows.
uint16_t takeNewer(const TileRow* said, uint16_t rows, TileColumns& newest, uint16_t shown);

}  // namespace shoal::mapping
