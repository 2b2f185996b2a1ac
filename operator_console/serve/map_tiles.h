// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "shoal/mapping/global_map.h"
#include "shoal/mapping/map_changes.h"

namespace shoal::console {

inline constexpr int32_t kTileSide = 32;  ///< columns of cells along a tile's edge
inline constexpr size_t kTileColumns = size_t{kTileSide} * kTileSide;

/// A cell that another lies over, in the same column.
struct LowerCell {
  uint16_t place;  ///< of its column
  int16_t height;  ///< z index, clamped
  int32_t label, seen;
  int16_t robot;
  uint8_t certainty, surprise;
  bool operator==(const LowerCell&) const = default;
};

/// A square of 32 x 32 columns of cells: what it looks like from above, of each column its highest cell, and
/// what lies below. Column (i, j) of the tile is at place j x 32 + i, i to the east, j to the north.
struct Tile {
  std::array<int32_t, kTileColumns> label;      ///< -1: nobody has been there
  std::array<int32_t, kTileColumns> seen;       ///< tenths of a second of mission time after the map's base
  std::array<int16_t, kTileColumns> robot;      ///< number of the robot that saw it last
  std::array<int16_t, kTileColumns> height;     ///< z index, clamped
  std::array<uint8_t, kTileColumns> certainty;  ///< [0, 1] in steps of 1/255
  std::array<uint8_t, kTileColumns> surprise;   ///< in steps of 1/8; 0: no more than usual
  std::vector<LowerCell> lower;                 ///< ascending by place, then height

  static Tile empty();
  bool operator==(const Tile&) const = default;
};

struct VersionedTile {
  uint64_t sequence = 0;  ///< number of the map in which it became what it is
  std::shared_ptr<const Tile> tile;
};

/// By tile index: floor(cell index / 32), x then y.
using TileMap = std::map<std::pair<int32_t, int32_t>, VersionedTile>;

/// The tiles of a map. Those that are as in `before` are shared with it and keep their sequence; those that
/// are gone stay as empty ones, so that whoever has `before` can be told.
/// @param surprises  of the map's cells, as mapping::ToldSurprises::of(); or empty.
/// @param base_s  mission time that `seen` counts from.
/// Cost: O(cells).
TileMap tilesOf(const mapping::GlobalMap& map, std::span<const uint8_t> surprises, double base_s,
                uint64_t sequence, const TileMap& before);

/// The tiles after a change of the map, which tells of whole columns of bricks; others are shared with
/// `before`. Cost: O(tiles), O(cells) for those that are told.
TileMap changedTiles(const mapping::MapChange& change, double base_s, uint64_t sequence,
                     const TileMap& before);

/// What there is to say of tiles, beside them.
struct TileHeader {
  double cell_size_m = 1, base_s = 0;
  uint64_t sequence = 0, life = 0;
};

/// Tiles newer than `since` as bytes, little-endian:
///   "SHT2", u32 number of tiles, f64 cell size (m), f64 base (s), u64 sequence, u64 since, u64 life, then a
///   tile: i32 x, i32 y, u32 number n of lower cells, u32 0, label i32[1024], seen i32[1024], robot
///   i16[1024], height i16[1024], certainty u8[1024], surprise u8[1024], and of the lower cells label i32[n],
///   seen i32[n], place u16[n], height i16[n], robot i16[n], certainty u8[n], surprise u8[n]
/// @param with_lower  without: n is 0.
std::string encodeTiles(const TileMap& tiles, uint64_t since, const TileHeader& header, bool with_lower);

}  // namespace shoal::console
