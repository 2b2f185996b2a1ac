// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/map_tile.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "shoal/mapping/global_map.h"
#include "shoal/mapping/piece.h"

namespace shoal::mapping {
namespace {

constexpr uint8_t kFree = 0xFF;  // height of a place of a sheet that nobody says anything of
using Heights = std::array<uint8_t, kTilePlaces>;

void makeAscending(std::vector<Utterance>& values) {
  std::ranges::sort(values);
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

uint32_t numberOf(const std::vector<Utterance>& ascending, const Utterance& utterance) {
  return static_cast<uint32_t>(std::ranges::lower_bound(ascending, utterance) - ascending.begin());
}

// The first sheet that has this cell, or room for it.
uint16_t sheetFor(uint8_t place, uint8_t height, std::vector<Heights>& sheets) {
  uint16_t s = 0;
  while (s < sheets.size() && sheets[s][place] != kFree && sheets[s][place] != height) ++s;
  if (s == sheets.size()) sheets.emplace_back().fill(kFree);
  sheets[s][place] = height;
  return s;
}

uint32_t loadRank(const std::byte* ranks, size_t i, size_t rank) {
  const auto load = [&]<class T>(T value) {
    std::memcpy(&value, ranks + i * sizeof(T), sizeof(T));
    return uint32_t{value};
  };
  return rank == 1 ? load(uint8_t{}) : rank == 2 ? load(uint16_t{}) : load(uint32_t{});
}

void storeRank(std::byte* ranks, size_t i, size_t rank, uint32_t value) {
  const auto store = [&]<class T>(T narrow) { std::memcpy(ranks + i * sizeof(T), &narrow, sizeof(T)); };
  if (rank == 1) return store(static_cast<uint8_t>(value));
  if (rank == 2) return store(static_cast<uint16_t>(value));
  store(value);
}

}  // namespace

struct MapTile::Said {
  world::RobotId robot{};
  uint8_t place = 0, height = 0, steps = 0;
  uint32_t utterance = 0;
};

std::span<const Voice> MapTile::voices() const {
  return {reinterpret_cast<const Voice*>(memory_.data()), num_utterances_};
}

std::span<const MapTile::Layer> MapTile::layers() const {
  return {reinterpret_cast<const Layer*>(memory_.data() + num_utterances_ * sizeof(Voice)), num_layers_};
}

std::span<const world::Timestamp> MapTile::times() const {
  return {reinterpret_cast<const world::Timestamp*>(memory_.data() + timesAt()), num_utterances_};
}

size_t MapTile::sheetAt(size_t s) const {
  return num_utterances_ * sizeof(Voice) + num_layers_ * sizeof(Layer) + s * kTilePlaces * (rank_ + 1u);
}

size_t MapTile::timesAt() const { return sheetAt(num_sheets_) + num_rows_ * kTileEdge * (rank_ + 1u); }

size_t MapTile::heightsAt(size_t s) const {
  return timesAt() + num_utterances_ * sizeof(world::Timestamp) + s * kTilePlaces;
}

bool MapTile::holds(world::RobotId robot) const {
  return std::ranges::binary_search(layers(), robot, {}, &Layer::robot);
}

void MapTile::set(world::RobotId robot, std::span<const TileCell> cells) {
  std::vector<Said> said = saidByOthers(robot);
  std::vector<char> is_used(num_utterances_, 0);
  for (const Said& s : said) is_used[s.utterance] = 1;
  std::vector<Utterance> now;
  for (size_t u = 0; u < num_utterances_; ++u)
    if (is_used[u]) now.push_back(utterance(u));
  for (const TileCell& c : cells) now.push_back({c.seen, {robot, c.topic}});
  makeAscending(now);
  std::vector<uint32_t> number(num_utterances_);
  for (size_t u = 0; u < num_utterances_; ++u) number[u] = numberOf(now, utterance(u));
  for (Said& s : said) s.utterance = number[s.utterance];

  std::vector<Said> own;
  own.reserve(cells.size());
  for (const TileCell& c : cells)
    own.push_back({robot, c.place, c.height, c.steps, numberOf(now, {c.seen, {robot, c.topic}})});
  said.insert(std::ranges::lower_bound(said, robot, {}, &Said::robot), own.begin(), own.end());
  build(said, now);
}

// In the order of their layers.
std::vector<MapTile::Said> MapTile::saidByOthers(world::RobotId robot) const {
  std::vector<Said> said;
  const std::byte* ranks = memory_.data() + sheetAt(num_sheets_);
  for (const Layer& layer : layers()) {
    const auto* const heights = reinterpret_cast<const uint8_t*>(memory_.data() + heightsAt(layer.sheet));
    const size_t num_places = static_cast<size_t>(std::popcount(layer.rows)) * kTileEdge;
    const std::byte* const certainty = ranks + num_places * rank_;
    size_t i = 0;
    for (unsigned rows = layer.rows; rows != 0 && layer.robot != robot; rows &= rows - 1) {
      const auto first = static_cast<size_t>(std::countr_zero(rows)) * kTileEdge;
      for (size_t place = first; place < first + kTileEdge; ++place, ++i) {
        const uint32_t rank = loadRank(ranks, i, rank_);
        if (rank == 0) continue;
        said.push_back({layer.robot, static_cast<uint8_t>(place), heights[place],
                        static_cast<uint8_t>(certainty[i]), rank - 1});
      }
    }
    ranks = certainty + num_places;
  }
  return said;
}

// Lays out anew what robots say, ascending by robot.
void MapTile::build(const std::vector<Said>& said, const std::vector<Utterance>& utterances) {
  std::vector<Heights> sheets;
  std::vector<uint16_t> sheet_of;
  std::vector<Layer> layers;
  std::vector<size_t> layer_of;  // by sheet, of the robot at hand
  num_rows_ = 0;
  for (size_t i = 0; i < said.size(); ++i) {
    const uint16_t sheet = sheet_of.emplace_back(sheetFor(said[i].place, said[i].height, sheets));
    if (i == 0 || said[i - 1].robot != said[i].robot) layer_of.clear();
    layer_of.resize(std::max(layer_of.size(), sheet + size_t{1}), SIZE_MAX);
    if (layer_of[sheet] == SIZE_MAX) {
      layer_of[sheet] = layers.size();
      layers.push_back({said[i].robot, sheet, 0});
    }
    uint16_t& rows = layers[layer_of[sheet]].rows;
    const auto row = static_cast<uint16_t>(1u << said[i].place / kTileEdge);
    num_rows_ += (rows & row) == 0 ? 1 : 0;
    rows = static_cast<uint16_t>(rows | row);
  }

  num_utterances_ = static_cast<uint32_t>(utterances.size());
  num_layers_ = static_cast<uint32_t>(layers.size());
  num_sheets_ = static_cast<uint16_t>(sheets.size());
  rank_ = num_utterances_ <= UINT8_MAX ? 1 : num_utterances_ <= UINT16_MAX ? 2 : 4;
  const size_t size = heightsAt(num_sheets_);
  memory_ = size == 0 ? TileMemory() : TileMemory(size);
  auto* const voice = reinterpret_cast<Voice*>(memory_.data());
  auto* const time = reinterpret_cast<world::Timestamp*>(memory_.data() + timesAt());
  std::ranges::transform(utterances, voice, &Utterance::voice);
  std::ranges::transform(utterances, time, &Utterance::seen);
  std::ranges::copy(layers, reinterpret_cast<Layer*>(memory_.data() + num_utterances_ * sizeof(Voice)));
  for (size_t s = 0; s < sheets.size(); ++s)
    std::memcpy(memory_.data() + heightsAt(s), sheets[s].data(), kTilePlaces);
  writeLayers(said, sheet_of);
}

void MapTile::writeLayers(std::span<const Said> said, const std::vector<uint16_t>& sheet_of) {
  struct At {
    std::byte* ranks = nullptr;
    unsigned rows = 0;
  };
  std::vector<At> own(num_sheets_);  // of the robot at hand
  std::byte* ranks = memory_.data() + sheetAt(num_sheets_);
  auto layer = layers().begin();
  for (size_t i = 0; i < said.size(); ++i) {
    if (i == 0 || said[i - 1].robot != said[i].robot) {
      for (; layer != layers().end() && layer->robot == said[i].robot; ++layer) {
        own[layer->sheet] = {ranks, layer->rows};
        ranks += static_cast<size_t>(std::popcount(layer->rows)) * kTileEdge * (rank_ + 1u);
      }
    }
    const auto& [first, rows] = own[sheet_of[i]];
    const unsigned row = said[i].place / unsigned{kTileEdge};
    const auto at = static_cast<size_t>(std::popcount(rows & ((1u << row) - 1u))) * kTileEdge +
                    said[i].place % size_t{kTileEdge};
    storeRank(first, at, rank_, said[i].utterance + 1);
    first[static_cast<size_t>(std::popcount(rows)) * kTileEdge * rank_ + at] = std::byte{said[i].steps};
  }
}

void MapTile::fold(const std::set<world::RobotId>& excluded) {
  uint32_t begun = 0;
  const std::byte* said = memory_.data() + sheetAt(num_sheets_);
  for (const Layer& layer : layers()) {
    if (excluded.empty() || !excluded.contains(layer.robot)) {
      const bool is_first = (begun >> layer.sheet & 1) == 0;
      takeNewer(said, layer.rows, rank_, memory_.data() + sheetAt(layer.sheet), is_first);
      begun |= 1u << layer.sheet;
    }
    said += static_cast<size_t>(std::popcount(layer.rows)) * kTileEdge * (rank_ + 1u);
  }
  for (size_t s = 0; s < num_sheets_; ++s)
    if ((begun >> s & 1) == 0) std::memset(memory_.data() + sheetAt(s), 0, kTilePlaces * (rank_ + 1u));
}

void MapTile::prefetch() const {
  constexpr int kIntoSecondCache = 2;
  for (size_t at = 0; at < timesAt(); at += TileMemory::kLine)
    __builtin_prefetch(memory_.data() + at, 0, kIntoSecondCache);
}

bool MapTile::read(size_t sheet, size_t place, Newest& cell) const {
  const std::byte* const ranks = memory_.data() + sheetAt(sheet);
  const uint32_t rank = loadRank(ranks, place, rank_);
  if (rank == 0) return false;
  cell.utterance = rank - 1;
  cell.steps = static_cast<uint8_t>(ranks[kTilePlaces * rank_ + place]);
  cell.height = static_cast<uint8_t>(memory_.data()[heightsAt(sheet) + place]);
  return true;
}

std::span<const std::byte> MapTile::shown(size_t sheet) const {
  return {memory_.data() + sheetAt(sheet), kTilePlaces * (rank_ + 1u)};
}

void MapTile::appendLabels(const LabelTable& table, std::vector<world::GlobalLabel>& labels) const {
  for (const Voice& voice : voices()) labels.push_back(table.of(voice));
}

void MapTile::count(const TileIndex& index) {
  struct Sum {
    int64_t cells = 0;
    uint64_t hash = 0;
  };
  std::vector<Sum> sums(num_utterances_);
  for (size_t s = 0; s < num_sheets_; ++s) {
    for (size_t place = 0; place < kTilePlaces; ++place) {
      Newest cell;
      if (!read(s, place, cell)) continue;
      const Utterance said = utterance(cell.utterance);
      Sum& sum = sums[cell.utterance];
      ++sum.cells;
      sum.hash += cellHash(
          {index.x * kTileEdge + static_cast<int32_t>(place) / kTileEdge,
           index.y * kTileEdge + static_cast<int32_t>(place) % kTileEdge, index.z * kTileEdge + cell.height},
          said.voice.first, said.seen, static_cast<float>(cell.steps) / kCertaintySteps);
    }
  }
  tallies_.clear();
  for (size_t u = 0; u < num_utterances_; ++u) {  // the earliest first
    if (sums[u].cells == 0) continue;
    const Utterance said = utterance(u);
    auto tally = std::ranges::lower_bound(tallies_, said.voice, {}, &Tally::voice);
    if (tally == tallies_.end() || tally->voice != said.voice)
      tally = tallies_.insert(tally, {said.voice, 0, said.seen, 0});
    tally->cells += sums[u].cells;
    tally->hash += sums[u].hash;
  }
}

}  // namespace shoal::mapping
