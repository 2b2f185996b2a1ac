// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/map_tile.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <stdexcept>

#include "shoal/mapping/global_map.h"
#include "shoal/mapping/piece.h"

namespace shoal::mapping {
namespace {

template <class T>
uint16_t placeOf(const std::vector<T>& ascending, const T& value) {
  return static_cast<uint16_t>(std::ranges::lower_bound(ascending, value) - ascending.begin());
}

template <class T>
void makeAscending(std::vector<T>& values) {
  std::ranges::sort(values);
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace

bool MapTile::holds(world::RobotId robot) const {
  return std::ranges::binary_search(layers_, robot, {}, &Layer::robot);
}

void MapTile::set(world::RobotId robot, std::span<const TileCell> cells) {
  auto layer = std::ranges::lower_bound(layers_, robot, {}, &Layer::robot);
  std::ptrdiff_t first = 0;  // of its rows
  for (auto before = layers_.begin(); before != layer; ++before) first += std::popcount(before->rows);
  if (layer != layers_.end() && layer->robot == robot) {
    said_.erase(said_.begin() + first, said_.begin() + first + std::popcount(layer->rows));
    layer = layers_.erase(layer);
  }
  if (cells.empty()) return;
  if (layers_.size() * kTileCells >= std::numeric_limits<uint16_t>::max() - kTileCells) {
    throw std::length_error("a tile of the map has room for 255 robots");
  }
  renumber(robot, cells);
  std::array<TileRow, kTileEdge> own;
  Layer said{robot, 0};
  for (const TileCell& c : cells) {
    const size_t row = c.place / size_t{kTileEdge}, place = c.place % size_t{kTileEdge};
    own[row].time[place] = static_cast<uint16_t>(placeOf(times_, c.seen) + 1);
    own[row].voice[place] = placeOf(voices_, Voice{robot, c.topic});
    own[row].certainty[place] = c.steps;
    said.rows = static_cast<uint16_t>(said.rows | 1u << row);
  }
  layers_.insert(layer, said);
  for (size_t row = 0; row < own.size(); ++row)
    if ((said.rows >> row & 1) != 0) said_.insert(said_.begin() + first++, own[row]);
}

// Numbers the times and voices that the layers use and that the new cells bring, and no others.
void MapTile::renumber(world::RobotId robot, std::span<const TileCell> cells) {
  std::vector<char> time_used(times_.size() + 1, 0), voice_used(voices_.size() + 1, 0);
  for (const TileRow& row : said_) {
    for (size_t i = 0; i < kTileEdge; ++i) {
      const bool said = row.time[i] != 0;
      time_used[row.time[i]] = 1;
      voice_used[said ? row.voice[i] : voices_.size()] = 1;
    }
  }
  std::vector<world::Timestamp> times;
  std::vector<Voice> voices;
  for (size_t t = 0; t < times_.size(); ++t)
    if (time_used[t + 1]) times.push_back(times_[t]);
  for (size_t v = 0; v < voices_.size(); ++v)
    if (voice_used[v]) voices.push_back(voices_[v]);
  for (const TileCell& c : cells) {
    times.push_back(c.seen);
    voices.emplace_back(robot, c.topic);
  }
  makeAscending(times);
  makeAscending(voices);

  std::vector<uint16_t> time_now(times_.size() + 1, 0), voice_now(voices_.size() + 1, 0);
  for (size_t t = 0; t < times_.size(); ++t)
    time_now[t + 1] = static_cast<uint16_t>(placeOf(times, times_[t]) + 1);
  for (size_t v = 0; v < voices_.size(); ++v) voice_now[v] = placeOf(voices, voices_[v]);
  for (TileRow& row : said_) {
    for (size_t i = 0; i < kTileEdge; ++i) {
      if (row.time[i] == 0) continue;
      row.time[i] = time_now[row.time[i]];
      row.voice[i] = voice_now[row.voice[i]];
    }
  }
  times_ = std::move(times);
  voices_ = std::move(voices);
}

void MapTile::fold(const std::set<world::RobotId>& excluded) {
  const unsigned before = shown_;
  const TileRow* said = said_.data();
  shown_ = 0;
  for (const Layer& layer : layers_) {
    if (excluded.empty() || !excluded.contains(layer.robot))
      shown_ = takeNewer(said, layer.rows, newest_, shown_);
    said += std::popcount(layer.rows);
  }
  for (unsigned gone = before & ~unsigned{shown_}; gone != 0; gone &= gone - 1) {
    const auto row = std::countr_zero(gone) * kTileEdge;
    std::fill_n(newest_.time.begin() + row, kTileEdge, uint16_t{0});
    std::fill_n(newest_.voice.begin() + row, kTileEdge, uint16_t{0});
    std::fill_n(newest_.certainty.begin() + row, kTileEdge, uint8_t{0});
  }
}

void MapTile::prefetch() const {
  constexpr size_t kLine = 64;
  __builtin_prefetch(layers_.data());
  const auto* const said = reinterpret_cast<const char*>(said_.data());
  for (size_t at = 0; at < said_.size() * sizeof(TileRow); at += kLine) __builtin_prefetch(said + at);
  for (unsigned rows = shown_; rows != 0; rows &= rows - 1) {
    const auto first = static_cast<size_t>(std::countr_zero(rows)) * kTileEdge;
    __builtin_prefetch(&newest_.time[first], 1);
    __builtin_prefetch(&newest_.voice[first], 1);
    __builtin_prefetch(&newest_.certainty[first], 1);
  }
}

void MapTile::count(const TileIndex& index) {
  std::vector<Tally> tallies(voices_.size());
  std::vector<uint16_t> first(voices_.size(), std::numeric_limits<uint16_t>::max());
  for (size_t i = 0; i < kTileCells; ++i) {
    const uint16_t time = (shown_ >> i / kTileEdge & 1) != 0 ? newest_.time[i] : uint16_t{0};
    if (time == 0) continue;
    const uint16_t voice = newest_.voice[i];
    Tally& tally = tallies[voice];
    ++tally.cells;
    first[voice] = std::min(first[voice], time);
    tally.hash += cellHash({index.x * kTileEdge + static_cast<int32_t>(i) / kTileEdge,
                            index.y * kTileEdge + static_cast<int32_t>(i) % kTileEdge, index.z},
                           voices_[voice].first, times_[time - 1u],
                           static_cast<float>(newest_.certainty[i]) / kCertaintySteps);
  }
  tallies_.clear();
  for (size_t v = 0; v < tallies.size(); ++v) {
    if (tallies[v].cells == 0) continue;
    tallies[v].voice = voices_[v];
    tallies[v].first_seen = times_[first[v] - 1u];
    tallies_.push_back(tallies[v]);
  }
}

}  // namespace shoal::mapping
