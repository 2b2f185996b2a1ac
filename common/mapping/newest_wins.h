// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

namespace shoal::mapping {

/// Cells of the fused map lie in tiles of 16 x 16 columns, sixteen cells high. A column's place in its tile
/// is (x mod 16) x 16 + y mod 16.
inline constexpr int32_t kTileEdge = 16;
inline constexpr size_t kTilePlaces = kTileEdge * kTileEdge;

/// Lets what one robot says of a sheet (map_tile.h) into what is shown of it, wherever it is newer.
/// @param said       of the rows of `rows`, ascending, sixteen places each: the rank of what is said, from 1,
///                   ascending by age; 0 says nothing. The bytes of certainty of as many rows follow.
/// @param rows       bit r: row r, of one x.
/// @param rank       1, 2 or 4 bytes in a rank.
/// @param newest     the same of all sixteen rows.
/// @param is_first   `newest` may hold anything and becomes what is said.
/// Cost: the bytes read and written. Nothing needs to be aligned.
void takeNewer(const std::byte* said, uint16_t rows, size_t rank, std::byte* newest, bool is_first);

}  // namespace shoal::mapping
