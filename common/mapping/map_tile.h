// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstdint>
#include <set>
#include <span>
#include <vector>

#include "shoal/mapping/label_table.h"
#include "shoal/mapping/newest_wins.h"
#include "shoal/world/ids.h"

namespace shoal::mapping {

/// Names a tile: its column of bricks, and its height as the z of its cells.
struct TileIndex {
  int32_t x = 0, y = 0, z = 0;
  auto operator<=>(const TileIndex&) const = default;
};

/// What one robot says of one cell of a tile.
struct TileCell {
  uint8_t place = 0;  ///< see TileColumns
  uint8_t steps = 0;  ///< certainty
  world::TopicId topic{};
  world::Timestamp seen;
};

/// A tile of the fused map: what every robot says of it, side by side, and of each cell the newest.
///
/// Times and voices are numbered within the tile, times in their order. So a cell takes five bytes, whatever
/// times and robots there are, and labels are not in it: a new matching leaves tiles as they are. Of a robot
/// only the rows of sixteen cells are held in which it says something: of a surface in 3-D a tile sees a
/// strip.
class MapTile {
 public:
  /// What a voice shows in this tile after fold().
  struct Tally {
    Voice voice;
    int64_t cells = 0;
    world::Timestamp first_seen;  ///< the earliest among them
    uint64_t hash = 0;            ///< sum over them of cellHash() (global_map.h)
  };

  /// Lets `robot` say these cells, each place once, and nothing else. None: it says nothing here.
  /// Cost: O(rows that robots say something of). @throws std::length_error for more than 255 robots.
  void set(world::RobotId robot, std::span<const TileCell> cells);

  bool holds(world::RobotId robot) const;
  bool isEmpty() const { return layers_.empty(); }

  /// Chooses the newest of every cell anew, the higher robot number among equals, as if the excluded robots
  /// had said nothing. Cost: O(rows that robots say something of), a vector each.
  void fold(const std::set<world::RobotId>& excluded);

  /// Has a core fetch what fold() will read, while it still folds tiles before. Changes nothing.
  void prefetch() const;

  /// Counts what fold() has chosen. `index` is where the tile lies.
  void count(const TileIndex& index);

  /// The outcome of fold(): read with times() and voices().
  const TileColumns& newest() const { return newest_; }
  uint16_t rowsShown() const { return shown_; }  ///< bit r: row r of newest() may hold a cell; no other does
  const std::vector<world::Timestamp>& times() const { return times_; }  ///< of rank 1, 2, ..: ascending
  const std::vector<Voice>& voices() const { return voices_; }           ///< by number: ascending
  /// The outcome of count(), ascending by voice.
  const std::vector<Tally>& tallies() const { return tallies_; }

 private:
  struct Layer {
    world::RobotId robot{};
    uint16_t rows = 0;  // bit r: it says something of row r
  };
  void renumber(world::RobotId robot, std::span<const TileCell> cells);

  std::vector<Layer> layers_;  // ascending by robot
  std::vector<TileRow> said_;  // their rows, one layer after the other
  TileColumns newest_;
  uint16_t shown_ = 0;
  std::vector<world::Timestamp> times_;
  std::vector<Voice> voices_;
  std::vector<Tally> tallies_;
};

}  // namespace shoal::mapping
