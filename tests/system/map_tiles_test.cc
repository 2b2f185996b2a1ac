// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/serve/map_tiles.h"

#include <cstring>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace shoal::console {
namespace {

using mapping::BrickColumn;
using mapping::GlobalCell;

// Cells that come, go and change, several in a column, on both sides of zero.
struct Changing {
  std::mt19937 random{11};
  std::map<world::CellIndex, GlobalCell> cells;

  // What a node would tell of it.
  mapping::MapChange change(int count) {
    std::uniform_int_distribution<int32_t> place(-70, 70), any(0, 99);
    mapping::MapChange change{.digest = "", .is_whole = false, .columns = {}, .part = {}, .surprises = {}};
    for (int n = 0; n < count; ++n) {
      const world::CellIndex cell{place(random), place(random), any(random) % 3 - 1};
      change.columns.emplace(cell.x >> 4, cell.y >> 4);
      if (any(random) < 25) {
        cells.erase(cell);
      } else {
        cells[cell] = {cell, world::GlobalLabel{any(random) % 5}, world::RobotId{any(random) % 3},
                       world::Timestamp{any(random) * 1'000'000}, static_cast<float>(any(random) % 64) / 63};
      }
    }
    for (const auto& [index, cell] : cells)
      if (change.columns.contains({index.x >> 4, index.y >> 4})) change.part.cells.push_back(cell);
    change.surprises = surprisesOf(change.part.cells);
    return change;
  }
  static uint8_t surpriseOf(const GlobalCell& c) {
    return c.seen.us % 7 == 0 ? static_cast<uint8_t>(12 + c.cell.x % 10) : uint8_t{0};
  }
  static std::vector<uint8_t> surprisesOf(const std::vector<GlobalCell>& cells) {
    std::vector<uint8_t> steps;
    for (const GlobalCell& c : cells) steps.push_back(surpriseOf(c));
    return steps;
  }
  mapping::GlobalMap map() const {
    mapping::GlobalMap map;
    for (const auto& [index, cell] : cells) map.cells.push_back(cell);
    return map;
  }
};

// Told of changes alone, tiles are those of the whole map, and those that stayed keep their sequence.
TEST(MapTilesTest, ChangesAddUpToTheWholeMap) {
  Changing changing;
  TileMap told, whole;
  for (uint64_t turn = 1; turn <= 60; ++turn) {
    SCOPED_TRACE(turn);
    told = changedTiles(changing.change(turn == 1 ? 4000 : static_cast<int>(turn % 5) * 4), 3, turn, told);
    whole = tilesOf(changing.map(), Changing::surprisesOf(changing.map().cells), 3, turn, whole);
    ASSERT_EQ(told.size(), whole.size());
    for (const auto& [key, is] : whole) {
      ASSERT_EQ(*told.at(key).tile, *is.tile) << key.first << ' ' << key.second;
      ASSERT_EQ(told.at(key).sequence, is.sequence) << key.first << ' ' << key.second;
    }
  }
}

// Every cell of the map stands once in a tile: the highest of a column on top.
TEST(MapTilesTest, HoldEveryCellOnce) {
  Changing changing;
  changing.change(5000);
  const TileMap tiles = tilesOf(changing.map(), Changing::surprisesOf(changing.map().cells), 0, 1, {});
  size_t held = 0, below = 0;
  for (const auto& [key, versioned] : tiles) {
    const Tile& tile = *versioned.tile;
    const auto cellAt = [&, k = key](size_t at, int16_t height) -> const GlobalCell& {
      return changing.cells.at({k.first * kTileSide + static_cast<int32_t>(at) % kTileSide,
                                k.second * kTileSide + static_cast<int32_t>(at) / kTileSide, height});
    };
    for (size_t at = 0; at < kTileColumns; ++at) {
      if (tile.label[at] < 0) continue;
      ++held;
      EXPECT_EQ(cellAt(at, tile.height[at]).label, world::GlobalLabel{tile.label[at]});
      EXPECT_EQ(Changing::surpriseOf(cellAt(at, tile.height[at])), tile.surprise[at]);
    }
    for (const LowerCell& c : tile.lower) {
      ++below;
      const GlobalCell& cell = cellAt(c.place, c.height);
      EXPECT_LT(c.height, tile.height[c.place]);
      EXPECT_EQ(cell.label, world::GlobalLabel{c.label});
      EXPECT_EQ(cell.robot, world::RobotId{c.robot});
      EXPECT_EQ(Changing::surpriseOf(cell), c.surprise);
      EXPECT_EQ(cell.seen.us, int64_t{c.seen} * 100'000);
    }
  }
  EXPECT_EQ(held + below, changing.cells.size());
  EXPECT_GT(below, 100u);

  // As bytes they take what is documented, and lower cells only when wanted.
  const auto sizeOf = [&](bool with_lower) { return encodeTiles(tiles, 0, {}, with_lower).size(); };
  EXPECT_EQ(sizeOf(false), 48 + tiles.size() * (16 + 1024 * 14));
  EXPECT_EQ(sizeOf(true), sizeOf(false) + 16 * below);
  uint32_t magic = 0;
  std::memcpy(&magic, encodeTiles(tiles, 1, {}, true).data() + 4, 4);
  EXPECT_EQ(magic, 0u);  // none is newer than the first
}

}  // namespace
}  // namespace shoal::console
