// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstdint>
#include <set>
#include <span>
#include <vector>

#include "shoal/mapping/label_table.h"
#include "shoal/mapping/newest_wins.h"
#include "shoal/mapping/tile_memory.h"
#include "shoal/world/ids.h"

namespace shoal::mapping {

/// Names a tile: its cells divided by kTileEdge, rounded down.
struct TileIndex {
  int32_t x = 0, y = 0, z = 0;
  auto operator<=>(const TileIndex&) const = default;
};

/// What one robot says of one cell of a tile.
struct TileCell {
  uint8_t place = 0;   ///< of its column; see kTilePlaces
  uint8_t height = 0;  ///< z mod kTileEdge
  uint8_t steps = 0;   ///< certainty
  world::TopicId topic{};
  world::Timestamp seen;
};

/// "This robot saw this topic then." Cells that say the same share one. Of two the greater is the newer.
struct Utterance {
  world::Timestamp seen;
  Voice voice;
  auto operator<=>(const Utterance&) const = default;
};

/// A tile of the fused map: what every robot says of it, side by side, and of each cell the newest.
///
/// Its cells lie in sheets. A sheet has one cell, of whatever height, in each of its 256 columns: a surface,
/// rough or flat, is one sheet, and what overhangs it goes into the next. All robots share the heights.
/// Utterances are numbered within the tile, the newest last, so that the newest of a cell is the greatest
/// number: a cell takes two bytes of every robot (three in tiles with more than 255 utterances, five above
/// 65,535), and an utterance sixteen, whatever times, robots and topics there are. Labels are not in it: a
/// new matching leaves tiles as they are. Of a robot only the rows of sixteen columns are held in which it
/// says something. All lies in one piece of memory.
class MapTile {
 public:
  /// What a voice shows in this tile after fold().
  struct Tally {
    Voice voice;
    int64_t cells = 0;
    world::Timestamp first_seen;  ///< the earliest among them
    uint64_t hash = 0;            ///< sum over them of cellHash() (global_map.h)
  };

  /// A cell as fold() has left it.
  struct Newest {
    uint8_t height = 0;
    uint8_t steps = 0;
    uint32_t utterance = 0;  ///< its number, from 0
  };

  /// Lets `robot` say these cells, each once, and nothing else. None: it says nothing here.
  /// Cost: O(cells that robots say something of).
  void set(world::RobotId robot, std::span<const TileCell> cells);

  bool holds(world::RobotId robot) const;
  bool isEmpty() const { return num_layers_ == 0; }

  /// Chooses the newest of every cell anew, the higher robot number among equals, as if the excluded robots
  /// had said nothing. Cost: O(rows that robots say something of), a few vectors each.
  void fold(const std::set<world::RobotId>& excluded);

  /// Has a core fetch what fold() will read, while it still folds tiles before. Changes nothing.
  void prefetch() const;

  /// Counts what fold() has chosen. `index` is where the tile lies.
  void count(const TileIndex& index);

  /// @name The outcome of fold(). @{
  size_t numUtterances() const { return num_utterances_; }
  Utterance utterance(size_t u) const { return {times()[u], voices()[u]}; }  ///< ascending
  size_t numSheets() const { return num_sheets_; }
  /// @returns false where nothing is said.
  bool read(size_t sheet, size_t place, Newest& cell) const;
  /// The number of what is said of every place, from 1, 0 where nothing is said, in so many bytes as the
  /// tile's numbers need; then the bytes of certainty.
  std::span<const std::byte> shown(size_t sheet) const;
  /// Appends the label of every utterance, by its number: a cell has that of its utterance.
  void appendLabels(const LabelTable& table, std::vector<world::GlobalLabel>& labels) const;
  /// @}

  /// The outcome of count(), ascending by voice.
  const std::vector<Tally>& tallies() const { return tallies_; }
  /// Memory held, this object left out.
  size_t bytes() const { return memory_.size() + tallies_.capacity() * sizeof(Tally); }

 private:
  struct Layer {  // what a robot says in a sheet
    world::RobotId robot{};
    uint16_t sheet = 0;
    uint16_t rows = 0;  // bit r: it says something of row r
  };
  struct Said;  // a cell, on the way into the tile or out of it

  std::vector<Said> saidByOthers(world::RobotId robot) const;
  void build(const std::vector<Said>& said, const std::vector<Utterance>& utterances);
  void writeLayers(std::span<const Said> said, const std::vector<uint16_t>& sheet_of);

  // In this order, in memory_: what fold() and label() read: utterances' voices, layers, of each sheet ranks
  // and certainties, of each layer its rows' ranks and certainties; then utterances' times, and of each sheet
  // heights.
  std::span<const Voice> voices() const;
  std::span<const Layer> layers() const;
  std::span<const world::Timestamp> times() const;
  size_t sheetAt(size_t sheet) const;
  size_t timesAt() const;
  size_t heightsAt(size_t sheet) const;

  TileMemory memory_;
  uint32_t num_utterances_ = 0, num_layers_ = 0, num_rows_ = 0;  // rows of all layers
  uint16_t num_sheets_ = 0, rank_ = 1;                           // bytes in a rank
  std::vector<Tally> tallies_;
};

}  // namespace shoal::mapping
