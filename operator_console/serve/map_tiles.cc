// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/serve/map_tiles.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

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

void put(Tile& tile, size_t at, const mapping::GlobalCell& c, double base_s) {
  const auto height = clamped<int16_t>(c.cell.z);
  if (tile.label[at] != kNobody && tile.height[at] > height) return;
  tile.label[at] = number(c.label);
  tile.seen[at] = clamped<int32_t>(std::floor((c.seen.seconds() - base_s) * 10));
  tile.robot[at] = clamped<int16_t>(number(c.robot));
  tile.height[at] = height;
  tile.certainty[at] = static_cast<uint8_t>(std::lround(std::clamp(c.certainty, 0.f, 1.f) * 255));
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

TileMap tilesOf(const mapping::GlobalMap& map, double base_s, uint64_t sequence, const TileMap& before) {
  std::map<std::pair<int32_t, int32_t>, std::shared_ptr<Tile>> drawn;
  std::pair<int32_t, int32_t> last{};
  Tile* tile = nullptr;
  for (const mapping::GlobalCell& c : map.cells) {
    const std::pair key(tileIndex(c.cell.x), tileIndex(c.cell.y));
    if (tile == nullptr || key != last) {
      auto& slot = drawn[key];
      if (!slot) slot = std::make_shared<Tile>(Tile::empty());
      tile = slot.get();
      last = key;
    }
    const auto i = static_cast<size_t>(c.cell.x - key.first * kTileSide);
    const auto j = static_cast<size_t>(c.cell.y - key.second * kTileSide);
    put(*tile, j * kTileSide + i, c, base_s);
  }
  for (const auto& [key, was] : before) {
    auto& slot = drawn[key];
    if (!slot) slot = std::make_shared<Tile>(Tile::empty());
  }
  TileMap tiles;
  for (auto& [key, is] : drawn) {
    const auto was = before.find(key);
    const bool same = was != before.end() && *was->second.tile == *is;
    tiles.emplace(key, same ? was->second : VersionedTile{sequence, std::move(is)});
  }
  return tiles;
}

std::string encodeTiles(const TileMap& tiles, uint64_t since, double cell_size_m, double base_s,
                        uint64_t sequence, uint64_t life) {
  const auto is_new = [since](const auto& entry) { return entry.second.sequence > since; };
  const auto count = static_cast<uint32_t>(std::ranges::count_if(tiles, is_new));
  std::string bytes = "SHT1";
  bytes.reserve(48 + count * (8 + sizeof(Tile)));
  append(bytes, count);
  append(bytes, cell_size_m);
  append(bytes, base_s);
  append(bytes, sequence);
  append(bytes, since);
  append(bytes, life);
  for (const auto& entry : tiles) {
    if (!is_new(entry)) continue;
    append(bytes, entry.first.first);
    append(bytes, entry.first.second);
    const Tile& tile = *entry.second.tile;
    append(bytes, tile.label);
    append(bytes, tile.seen);
    append(bytes, tile.robot);
    append(bytes, tile.height);
    append(bytes, tile.certainty);
  }
  return bytes;
}

}  // namespace shoal::console
