// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/map_tile.h"

#include <algorithm>
#include <map>
#include <tuple>

#include <gtest/gtest.h>

#include "shoal/mapping/global_map.h"
#include "shoal/mapping/piece.h"
#include "shoal/random.h"

namespace shoal::mapping {
namespace {

using world::GlobalLabel;
using world::RobotId;
using world::TopicId;

using Place = std::pair<uint8_t, uint8_t>;  // of its column, height
constexpr TileIndex kIndex{-2, 3, -1};

// What robots say, cell by cell.
class PlainTile {
 public:
  void set(RobotId robot, const std::vector<TileCell>& cells) {
    said_.erase(robot);  // and it is not held when it says nothing
    for (const TileCell& c : cells) said_[robot][{c.place, c.height}] = c;
  }
  bool holds(RobotId robot) const { return said_.contains(robot); }

  struct Shown {
    Utterance said;
    uint8_t steps = 0;
    auto operator<=>(const Shown&) const = default;
  };
  std::map<Place, Shown> newest(const std::set<RobotId>& excluded) const {
    std::map<Place, Shown> newest;
    for (const auto& [robot, cells] : said_) {
      if (excluded.contains(robot)) continue;
      for (const auto& [place, c] : cells) {
        const Shown mine{{c.seen, {robot, c.topic}}, c.steps};
        const auto [held, is_new] = newest.emplace(place, mine);
        if (!is_new && held->second.said.seen <= c.seen) held->second = mine;
      }
    }
    return newest;
  }

 private:
  std::map<RobotId, std::map<Place, TileCell>> said_;
};

void expectEqual(MapTile& tile, const PlainTile& plain, const std::set<RobotId>& excluded) {
  tile.fold(excluded);
  tile.count(kIndex);
  const auto expected = plain.newest(excluded);
  std::vector<GlobalLabel> labels{GlobalLabel{-5}};  // they are appended
  LabelTable table;
  table.set({RobotId{1}, TopicId{2}}, GlobalLabel{77});
  tile.appendLabels(table, labels);
  ASSERT_EQ(labels.size(), 1 + tile.numUtterances());

  std::map<Place, PlainTile::Shown> shown;
  for (size_t s = 0; s < tile.numSheets(); ++s) {
    for (size_t place = 0; place < kTilePlaces; ++place) {
      MapTile::Newest cell;
      if (!tile.read(s, place, cell)) continue;
      const Utterance said = tile.utterance(cell.utterance);
      ASSERT_EQ(labels[1 + cell.utterance], table.of(said.voice));
      const bool is_once =
          shown.emplace(Place{static_cast<uint8_t>(place), cell.height}, PlainTile::Shown{said, cell.steps})
              .second;
      ASSERT_TRUE(is_once);
    }
  }
  ASSERT_EQ(shown, expected);

  std::map<Voice, std::tuple<int64_t, int64_t, uint64_t>> expected_tallies, tallies;
  for (const auto& [place, c] : expected) {
    auto& [cells, first, hash] =
        expected_tallies.try_emplace(c.said.voice, 0, c.said.seen.us, 0).first->second;
    ++cells;
    first = std::min(first, c.said.seen.us);
    hash += cellHash(
        {kIndex.x * 16 + place.first / 16, kIndex.y * 16 + place.first % 16, kIndex.z * 16 + place.second},
        c.said.voice.first, c.said.seen, static_cast<float>(c.steps) / kCertaintySteps);
  }
  for (const MapTile::Tally& t : tile.tallies()) {
    if (!tallies.empty()) {
      ASSERT_LT(tallies.rbegin()->first, t.voice);
    }
    tallies[t.voice] = {t.cells, t.first_seen.us, t.hash};
  }
  ASSERT_EQ(tallies, expected_tallies);
}

// Robots come, change and go; they see a surface, a few cells, or all of a box; few times, so that many are
// equal, or a time a cell.
TEST(MapTileTest, ShowsOfEveryCellTheNewest) {
  for (uint64_t seed = 0; seed < 12; ++seed) {
    Random random(seed, 0);
    const auto below = [&random](uint64_t n) { return random.below(n); };
    const uint64_t num_times = seed % 3 == 0 ? 3 : seed % 3 == 1 ? 60 : 100'000;
    MapTile tile;
    PlainTile plain;
    for (int step = 0; step < 40; ++step) {
      const RobotId robot{static_cast<int32_t>(below(5))};
      std::vector<TileCell> cells;
      const uint64_t kind = below(5), slope = 1 + below(8);
      for (uint64_t place = 0; place < kTilePlaces; ++place) {
        for (uint64_t height = 0; height < 16; ++height) {
          const bool is_said = kind == 0   ? false
                               : kind == 1 ? below(300) == 0
                               : kind == 2 ? height == (place / 16 + place % 16) / slope % 16
                               : kind == 3 ? place / 16 >= 3 && height == below(16)
                                           : place / 16 < slope && place % 16 < 5 && height < 3;
          if (!is_said) continue;
          cells.push_back({static_cast<uint8_t>(place),
                           static_cast<uint8_t>(height),
                           static_cast<uint8_t>(below(kCertaintySteps + 1)),
                           TopicId{static_cast<int32_t>(below(4))},
                           {static_cast<int64_t>(below(num_times)) - 1}});
        }
      }
      tile.set(robot, cells);
      plain.set(robot, cells);
      for (int32_t r = 0; r < 5; ++r) ASSERT_EQ(tile.holds(RobotId{r}), plain.holds(RobotId{r}));
      std::set<RobotId> excluded;
      for (int32_t r = 0; r < 5; ++r)
        if (below(4) == 0) excluded.insert(RobotId{r});
      ASSERT_NO_FATAL_FAILURE(expectEqual(tile, plain, excluded)) << "seed " << seed << ", step " << step;
      ASSERT_NO_FATAL_FAILURE(expectEqual(tile, plain, {})) << "seed " << seed << ", step " << step;
    }
    for (int32_t r = 0; r < 5; ++r) tile.set(RobotId{r}, {});
    EXPECT_TRUE(tile.isEmpty());
    EXPECT_EQ(tile.numSheets(), 0u);
    tile.fold({});
    tile.count(kIndex);
    EXPECT_TRUE(tile.tallies().empty());
  }
}

// Seventeen robots that say each of 4096 cells at a time of its own: 69,632 utterances.
TEST(MapTileTest, HoldsMoreUtterancesThanTwoBytesCount) {
  MapTile tile;
  PlainTile plain;
  Random random(5, 1);
  for (int32_t r = 0; r < 17; ++r) {
    std::vector<TileCell> cells;
    for (size_t i = 0; i < 4096; ++i)
      cells.push_back({static_cast<uint8_t>(i / 16),
                       static_cast<uint8_t>(i % 16),
                       static_cast<uint8_t>(r),
                       TopicId{1},
                       {static_cast<int64_t>(random.below(1'000'000'000))}});
    tile.set(RobotId{r}, cells);
    plain.set(RobotId{r}, cells);
  }
  ASSERT_GT(tile.numUtterances(), 65535u);
  expectEqual(tile, plain, {});
  expectEqual(tile, plain, {RobotId{0}, RobotId{9}, RobotId{16}});
}

// The page's server keeps a copy of the map while the first goes on.
TEST(MapTileTest, ACopyGoesItsOwnWay) {
  const std::vector<TileCell> old{{3, 4, 9, TopicId{1}, {10}}}, young{{3, 4, 5, TopicId{2}, {20}}};
  MapTile tile;
  PlainTile plain, changed;
  tile.set(RobotId{1}, old);
  plain.set(RobotId{1}, old);
  MapTile copy = tile;
  copy.set(RobotId{2}, young);
  changed.set(RobotId{1}, old);
  changed.set(RobotId{2}, young);
  expectEqual(copy, changed, {});
  expectEqual(tile, plain, {});
  copy = MapTile{};
  EXPECT_TRUE(copy.isEmpty());
  expectEqual(tile, plain, {});
  tile = MapTile(tile);
  expectEqual(tile, plain, {});
}

// A rough surface is one sheet; two bytes a cell of every robot and three for the one that is shown, and what
// says who says what when.
TEST(MapTileTest, HoldsASurfaceInOneSheet) {
  MapTile tile;
  std::vector<TileCell> cells;
  for (size_t place = 0; place < kTilePlaces; ++place)
    cells.push_back(
        {static_cast<uint8_t>(place), static_cast<uint8_t>(mix64(place) % 16), 9, TopicId{3}, {7}});
  for (int32_t r = 0; r < 12; ++r) tile.set(RobotId{r}, cells);
  EXPECT_EQ(tile.numSheets(), 1u);
  EXPECT_LE(tile.bytes(), 256u * (12 * 2 + 3) + 12 * 24);
}

}  // namespace
}  // namespace shoal::mapping
