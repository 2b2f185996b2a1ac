// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/map_tile.h"

#include <algorithm>
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
  const bool held = layer != layers_.end() && layer->robot == robot;
  if (held && cells.empty()) layers_.erase(layer);
  if (cells.empty()) return;
  if (held) {
    layer->said = {};
  } else {
    if (layers_.size() * kTileCells >= std::numeric_limits<uint16_t>::max() - kTileCells) {
      throw std::length_error("a tile of the map has room for 255 robots");
    }
    layer = layers_.insert(layer, Layer{robot, {}});
  }
  renumber(robot, cells);
  for (const TileCell& c : cells) {
    layer->said.time[c.place] = static_cast<uint16_t>(placeOf(times_, c.seen) + 1);
    layer->said.voice[c.place] = placeOf(voices_, Voice{robot, c.topic});
    layer->said.certainty[c.place] = c.steps;
  }
}

// Numbers the times and voices that the layers use and that the new cells bring, and no others.
void MapTile::renumber(world::RobotId robot, std::span<const TileCell> cells) {
  std::vector<char> time_used(times_.size() + 1, 0), voice_used(voices_.size() + 1, 0);
  for (const Layer& layer : layers_) {
    for (size_t i = 0; i < kTileCells; ++i) {
      const bool said = layer.said.time[i] != 0;
      time_used[layer.said.time[i]] = 1;
      voice_used[said ? layer.said.voice[i] : voices_.size()] = 1;
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
  for (Layer& layer : layers_) {
    for (size_t i = 0; i < kTileCells; ++i) {
      if (layer.said.time[i] == 0) continue;
      layer.said.time[i] = time_now[layer.said.time[i]];
      layer.said.voice[i] = voice_now[layer.said.voice[i]];
    }
  }
  times_ = std::move(times);
  voices_ = std::move(voices);
}

void MapTile::fold(const std::set<world::RobotId>& excluded) {
  newest_ = {};
  for (const Layer& layer : layers_) {
    if (excluded.empty() || !excluded.contains(layer.robot)) takeNewer(layer.said, newest_);
  }
}

void MapTile::count(const TileIndex& index) {
  std::vector<Tally> tallies(voices_.size());
  std::vector<uint16_t> first(voices_.size(), std::numeric_limits<uint16_t>::max());
  for (size_t i = 0; i < kTileCells; ++i) {
    const uint16_t time = newest_.time[i];
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
