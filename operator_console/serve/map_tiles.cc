// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/serve/map_tiles.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <span>

#include "shoal/mapping/piece.h"

namespace shoal::console {
namespace {

static_assert(std::endian::native == std::endian::little, "tiles are copied as they lie in memory");

constexpr int32_t kNobody = -1;

int32_t tileIndex(int32_t cell) {
  return cell >= 0 ? cell / kTileSide : static_cast<int32_t>(-((-int64_t{cell} + kTileSide - 1) / kTileSide));
}

template <class Narrow, class Wide>
Narrow clamped(Wide value) {
  return static_cast<Narrow>(std::clamp<Wide>(value, Wide{std::numeric_limits<Narrow>::min()},
                                              Wide{std::numeric_limits<Narrow>::max()}));
}

// Cells of a column come from low to high.
void put(Tile& tile, size_t at, const mapping::GlobalCell& c, uint8_t surprise, double base_s) {
  if (tile.label[at] != kNobody) {
    tile.lower.push_back({static_cast<uint16_t>(at), tile.height[at], tile.label[at], tile.seen[at],
                          tile.robot[at], tile.certainty[at], tile.surprise[at]});
  }
  tile.label[at] = number(c.label);
  tile.seen[at] = clamped<int32_t>(std::floor((c.seen.seconds() - base_s) * 10));
  tile.robot[at] = clamped<int16_t>(number(c.robot));
  tile.height[at] = clamped<int16_t>(c.cell.z);
  tile.certainty[at] = static_cast<uint8_t>(std::lround(std::clamp(c.certainty, 0.f, 1.f) * 255));
  tile.surprise[at] = surprise;
}

using TileKey = std::pair<int32_t, int32_t>;

// Tiles that are being drawn.
class Drawing {
 public:
  explicit Drawing(double base_s) : base_s_(base_s) {}

  Tile& begin(const TileKey& key, const Tile& from) { return *(tiles_[key] = std::make_shared<Tile>(from)); }

  void put(const std::vector<mapping::GlobalCell>& cells, std::span<const uint8_t> surprises) {
    TileKey last{};
    Tile* tile = nullptr;
    for (size_t n = 0; n < cells.size(); ++n) {
      const mapping::GlobalCell& c = cells[n];
      const TileKey key(tileIndex(c.cell.x), tileIndex(c.cell.y));
      if (tile == nullptr || key != last) {
        auto& slot = tiles_[key];
        if (!slot) slot = std::make_shared<Tile>(Tile::empty());
        tile = slot.get();
        last = key;
      }
      const auto i = static_cast<size_t>(c.cell.x - key.first * kTileSide);
      const auto j = static_cast<size_t>(c.cell.y - key.second * kTileSide);
      console::put(*tile, j * kTileSide + i, c, surprises.empty() ? uint8_t{0} : surprises[n], base_s_);
    }
  }

  // Those that look as before stay what they were.
  TileMap settled(uint64_t sequence, const TileMap& before) {
    TileMap tiles = before;
    for (auto& [key, is] : tiles_) {
      std::ranges::sort(is->lower, {}, [](const LowerCell& c) { return std::pair(c.place, c.height); });
      const auto was = before.find(key);
      if (was == before.end() || *was->second.tile != *is) tiles[key] = {sequence, std::move(is)};
    }
    return tiles;
  }

 private:
  double base_s_;
  std::map<TileKey, std::shared_ptr<Tile>> tiles_;
};

void clear(Tile& tile, const mapping::BrickColumn& column, const TileKey& key) {
  const auto i0 = static_cast<size_t>(column.first * mapping::kBrickEdge - key.first * kTileSide);
  const auto j0 = static_cast<size_t>(column.second * mapping::kBrickEdge - key.second * kTileSide);
  const Tile nothing = Tile::empty();
  const auto is_in = [i0, j0](size_t place) {
    const size_t i = place % kTileSide, j = place / kTileSide;
    return i >= i0 && i < i0 + mapping::kBrickEdge && j >= j0 && j < j0 + mapping::kBrickEdge;
  };
  for (size_t at = 0; at < kTileColumns; ++at) {
    if (!is_in(at)) continue;
    tile.label[at] = nothing.label[at];
    tile.seen[at] = nothing.seen[at];
    tile.robot[at] = nothing.robot[at];
    tile.height[at] = nothing.height[at];
    tile.certainty[at] = nothing.certainty[at];
    tile.surprise[at] = nothing.surprise[at];
  }
  std::erase_if(tile.lower, [&is_in](const LowerCell& c) { return is_in(c.place); });
}

template <class T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

Tile Tile::empty() {
  Tile tile{};
  tile.label.fill(kNobody);
  tile.robot.fill(kNobody);
  return tile;
}

TileMap tilesOf(const mapping::GlobalMap& map, std::span<const uint8_t> surprises, double base_s,
                uint64_t sequence, const TileMap& before) {
  Drawing drawing(base_s);
  for (const auto& [key, was] : before) drawing.begin(key, Tile::empty());
  drawing.put(map.cells, surprises);
  return drawing.settled(sequence, before);
}

TileMap changedTiles(const mapping::MapChange& change, double base_s, uint64_t sequence,
                     const TileMap& before) {
  if (change.is_whole) return tilesOf(change.part, change.surprises, base_s, sequence, before);
  static_assert(kTileSide == 2 * mapping::kBrickEdge);
  Drawing drawing(base_s);
  std::map<TileKey, Tile*> begun;
  for (const mapping::BrickColumn& column : change.columns) {
    const TileKey key(column.first >> 1, column.second >> 1);
    Tile*& tile = begun[key];
    if (tile == nullptr) {
      const auto was = before.find(key);
      tile = &drawing.begin(key, was == before.end() ? Tile::empty() : *was->second.tile);
    }
    clear(*tile, column, key);
  }
  drawing.put(change.part.cells, change.surprises);
  return drawing.settled(sequence, before);
}

std::string encodeTiles(const TileMap& tiles, uint64_t since, const TileHeader& header, bool with_lower) {
  const auto is_new = [since](const auto& entry) { return entry.second.sequence > since; };
  const auto count = static_cast<uint32_t>(std::ranges::count_if(tiles, is_new));
  std::string bytes = "SHT2";
  bytes.reserve(48 + count * (16 + sizeof(Tile)));
  append(bytes, count);
  append(bytes, header.cell_size_m);
  append(bytes, header.base_s);
  append(bytes, header.sequence);
  append(bytes, since);
  append(bytes, header.life);
  for (const auto& entry : tiles) {
    if (!is_new(entry)) continue;
    const Tile& tile = *entry.second.tile;
    const std::span<const LowerCell> lower =
        with_lower ? std::span(tile.lower) : std::span<const LowerCell>();
    append(bytes, entry.first.first);
    append(bytes, entry.first.second);
    append(bytes, static_cast<uint32_t>(lower.size()));
    append(bytes, uint32_t{0});
    append(bytes, tile.label);
    append(bytes, tile.seen);
    append(bytes, tile.robot);
    append(bytes, tile.height);
    append(bytes, tile.certainty);
    append(bytes, tile.surprise);
    for (const LowerCell& c : lower) append(bytes, c.label);
    for (const LowerCell& c : lower) append(bytes, c.seen);
    for (const LowerCell& c : lower) append(bytes, c.place);
    for (const LowerCell& c : lower) append(bytes, c.height);
    for (const LowerCell& c : lower) append(bytes, c.robot);
    for (const LowerCell& c : lower) append(bytes, c.certainty);
    for (const LowerCell& c : lower) append(bytes, c.surprise);
  }
  return bytes;
}

}  // namespace shoal::console
