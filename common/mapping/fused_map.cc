// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/fused_map.h"

#include <algorithm>
#include <limits>
#include <span>
#include <tuple>

#include "shoal/demand.h"
#include "shoal/mapping/common_settings.h"
#include "shoal/mapping/label_identity.h"
#include "shoal/mapping/library.h"
#include "shoal/mapping/topic_matching.h"

namespace shoal::mapping {
namespace {

static_assert(kTileEdge == kBrickEdge);
constexpr size_t kAhead = 4;  // tiles that are being fetched while one is folded

bool isInBrick(const world::CellIndex& cell, const std::array<int32_t, 3>& brick) {
  return brickOf(cell) == brick;
}

// A brick's cells by cell. A cell that several parts tell of (honest ones do not) is there
// once: the newest, the earlier part's among equals.
std::vector<BrickCell> labelledCells(const BeliefStore& beliefs, world::RobotId robot,
                                     const std::array<int32_t, 3>& brick) {
  std::vector<BrickCell> cells;
  beliefs.visitOf(PieceKey{robot, PieceKind::kBrick, brick}, [&](const Piece& piece) {
    const auto& part = std::get<BrickPart>(piece.content).cells;
    cells.insert(cells.end(), part.begin(), part.end());
  });
  const auto order = [](const BrickCell& c) { return std::tuple(c.cell, -c.seen.us); };
  if (!std::ranges::is_sorted(cells, {}, order)) std::ranges::stable_sort(cells, {}, order);
  const auto same = [](const BrickCell& a, const BrickCell& b) { return a.cell == b.cell; };
  cells.erase(std::unique(cells.begin(), cells.end(), same), cells.end());
  return cells;
}

// Its certainties by cell; of several for a cell the last part's.
std::vector<CertaintyCell> certainties(const BeliefStore& beliefs, world::RobotId robot,
                                       const std::array<int32_t, 3>& brick) {
  std::vector<CertaintyCell> cells;
  beliefs.visitOf(PieceKey{robot, PieceKind::kCertainty, brick}, [&](const Piece& piece) {
    const auto& part = std::get<CertaintyPart>(piece.content).cells;
    cells.insert(cells.begin(), part.begin(), part.end());
  });
  if (!std::ranges::is_sorted(cells, {}, &CertaintyCell::cell))
    std::ranges::stable_sort(cells, {}, &CertaintyCell::cell);
  return cells;
}

uint8_t stepsOf(const std::vector<CertaintyCell>& certain, const world::CellIndex& cell) {
  const auto found = std::ranges::lower_bound(certain, cell, {}, &CertaintyCell::cell);
  return found != certain.end() && found->cell == cell ? found->steps : uint8_t{0};
}

uint8_t placeOf(const world::CellIndex& cell) {
  return static_cast<uint8_t>((cell.x & (kTileEdge - 1)) * kTileEdge + (cell.y & (kTileEdge - 1)));
}

uint8_t heightOf(const world::CellIndex& cell) { return static_cast<uint8_t>(cell.z & (kTileEdge - 1)); }

bool containsRobot(const std::vector<world::RobotId>& robots, world::RobotId robot) {
  return std::ranges::find(robots, robot) != robots.end();
}

// Names stick to topics: a label has the newest name of its topics.
void giveNames(std::vector<LabelSummary>& rows, const Judgement& judgement,
               const std::vector<Correspondence>& correspondences) {
  if (judgement.names.empty()) return;
  std::map<world::GlobalLabel, std::vector<Topic>> topics;
  for (const Correspondence& c : correspondences) topics[c.label].push_back({c.robot, c.topic});
  for (LabelSummary& row : rows) {
    topics[row.label].push_back(
        {world::RobotId{number(row.label) / 10000}, world::TopicId{number(row.label) % 10000}});
    row.name = judgement.nameOf(topics[row.label]);
  }
}

struct ReadTile {
  ReadTile(const TileIndex& at, const MapTile& what, const LabelTable& label) : index(at), tile(&what) {
    what.appendLabels(label, labels);
  }
  TileIndex index;
  const MapTile* tile;
  std::vector<world::GlobalLabel> labels;  // by utterance
};

// The cells of one column of a tile, upwards.
void readPlace(const ReadTile& from, int32_t place, std::vector<GlobalCell>& cells) {
  const auto& [index, tile, labels] = from;
  const size_t num_before = cells.size();
  for (size_t s = 0; s < tile->numSheets(); ++s) {
    MapTile::Newest cell;
    if (!tile->read(s, static_cast<size_t>(place), cell)) continue;
    const Utterance said = tile->utterance(cell.utterance);
    cells.push_back({{index.x * kTileEdge + place / kTileEdge, index.y * kTileEdge + place % kTileEdge,
                      index.z * kTileEdge + cell.height},
                     labels[cell.utterance],
                     said.voice.first,
                     said.seen,
                     static_cast<float>(cell.steps) / kCertaintySteps});
  }
  if (cells.size() > num_before + 1)
    std::ranges::sort(cells.begin() + static_cast<std::ptrdiff_t>(num_before), cells.end(), {},
                      &GlobalCell::cell);
}

// Cells ascend by x, y, z. Tiles of one x, ascending by y, then z: each of their sixteen columns of x is gone
// through in that order.
void readRow(const std::vector<ReadTile>& row, std::vector<GlobalCell>& cells) {
  for (int32_t x = 0; x < kTileEdge; ++x) {
    for (size_t from = 0, to = 0; from < row.size(); from = to) {
      while (to < row.size() && row[to].index.y == row[from].index.y) ++to;
      for (int32_t place = x * kTileEdge; place < (x + 1) * kTileEdge; ++place)
        for (size_t r = from; r < to; ++r) readPlace(row[r], place, cells);
    }
  }
}

}  // namespace

void FusedMap::update(const BeliefStore& beliefs, const matching::MatcherOptions& options) {
  Judgement judgement = judge(beliefs);
  judgement.excluded.merge(robotsOfOtherCells(beliefs, judgement.excluded));
  std::set<TileIndex> touched;
  for (const RobotBrick& brick : changes(beliefs)) readBrick(beliefs, brick, touched);
  exclude(judgement.excluded, touched);
  std::vector<std::pair<TileIndex, MapTile*>> tiles;
  for (const TileIndex& index : touched) tiles.emplace_back(index, &tiles_.at(index));
  for (size_t t = 0; t < tiles.size(); ++t) {
    if (t + kAhead < tiles.size()) tiles[t + kAhead].second->prefetch();
    foldTile(tiles[t].first, *tiles[t].second);
  }

  const StackedTopics stacked = stack(beliefs, excluded_, heard_cells_);  // canonical, whatever came first
  matchAnew(stacked, options, judgement);
  relabel(stacked, judgement);
  state_digest_ = beliefs.digest();
}

void FusedMap::matchAnew(const StackedTopics& stacked, const matching::MatcherOptions& options,
                         const Judgement& judgement) {
  Asked asked{options,           {}, stacked.vertex, stacked.descriptors, judgement.links, judgement.apart,
              judgement.excluded};
  for (const HeardTopic& topic : stacked.topics) asked.topics.emplace_back(topic.robot, topic.id);
  if (asked_ == asked) return;
  clustering_ = matchTopics(stacked, options, judgement, &memory_);
  asked_ = std::move(asked);
}

// The bricks of robots to be read anew: those that changed, and all of a robot that began a new epoch.
std::set<FusedMap::RobotBrick> FusedMap::changes(const BeliefStore& beliefs) {
  std::set<RobotBrick> changed;
  for (const world::RobotId robot : beliefs.robots()) {
    const int32_t epoch = beliefs.epochOf(robot);
    const auto [known, is_new] = epochs_.emplace(robot, epoch);
    if (is_new || known->second == epoch) continue;
    known->second = epoch;
    for (auto at = spoken_.lower_bound({robot, {INT32_MIN, INT32_MIN, INT32_MIN}});
         at != spoken_.end() && at->first.first == robot; ++at)
      changed.insert(at->first);
  }
  beliefs.visitChanges(revision_, [&](const PieceKey& key) {
    if (key.kind == PieceKind::kBrick || key.kind == PieceKind::kCertainty)
      changed.emplace(key.robot, key.index);
  });
  revision_ = beliefs.revision();
  return changed;
}

void FusedMap::readBrick(const BeliefStore& beliefs, const RobotBrick& at, std::set<TileIndex>& touched) {
  const auto robot = at.first;
  const auto& brick = at.second;
  Spoken spoken;
  beliefs.visitOf(PieceKey{robot, PieceKind::kBrick, brick}, [&](const Piece& piece) {
    for (const BrickCell& c : std::get<BrickPart>(piece.content).cells) {
      SHOAL_DEMAND(isInBrick(c.cell, brick));
      auto tally = std::ranges::find(spoken, c.topic, [](const auto& t) { return t.first; });
      if (tally == spoken.end()) tally = spoken.insert(tally, {c.topic, 0});
      ++tally->second;
    }
  });
  Spoken& before = spoken_[at];
  if (!before.empty() || !spoken.empty()) {
    const std::vector<CertaintyCell> certain = certainties(beliefs, robot, brick);
    std::vector<TileCell> said;
    for (const BrickCell& c : labelledCells(beliefs, robot, brick))
      said.push_back({placeOf(c.cell), heightOf(c.cell), stepsOf(certain, c.cell), c.topic, c.seen});
    const TileIndex index{brick[0], brick[1], brick[2]};
    tiles_[index].set(robot, said);
    touched.insert(index);
  }
  countHeard(robot, before, -1);
  countHeard(robot, spoken, +1);
  before = std::move(spoken);
  if (before.empty()) spoken_.erase(at);
}

void FusedMap::countHeard(world::RobotId robot, const Spoken& spoken, int64_t sign) {
  for (const auto& [topic, cells] : spoken) {
    const auto counted = heard_cells_.emplace(Voice{robot, topic}, 0).first;
    counted->second += sign * cells;
    if (counted->second == 0) heard_cells_.erase(counted);
  }
}

void FusedMap::exclude(const std::set<world::RobotId>& robots, std::set<TileIndex>& touched) {
  if (robots == excluded_) return;
  std::vector<world::RobotId> judged_anew;
  std::ranges::set_symmetric_difference(robots, excluded_, std::back_inserter(judged_anew));
  for (const auto& each : tiles_) {
    if (std::ranges::any_of(judged_anew, [&](world::RobotId robot) { return each.second.holds(robot); }))
      touched.insert(each.first);
  }
  excluded_ = robots;
}

void FusedMap::foldTile(const TileIndex& index, MapTile& tile) {
  for (const MapTile::Tally& tally : tile.tallies()) {
    const auto shown = shown_.find(tally.voice);
    num_cells_ -= tally.cells;
    shown->second.hash -= tally.hash;
    const auto first = shown->second.firsts.find(tally.first_seen);
    if (--first->second == 0) shown->second.firsts.erase(first);
    if ((shown->second.cells -= tally.cells) == 0) shown_.erase(shown);
  }
  tile.fold(excluded_);
  tile.count(index);
  for (const MapTile::Tally& tally : tile.tallies()) {
    Shown& shown = shown_[tally.voice];
    num_cells_ += tally.cells;
    shown.cells += tally.cells;
    shown.hash += tally.hash;
    ++shown.firsts[tally.first_seen];
  }
  if (tile.isEmpty()) tiles_.erase(index);
}

void FusedMap::relabel(const StackedTopics& stacked, const Judgement& judgement) {
  const std::vector<world::GlobalLabel> labels = stableLabels(stacked, clustering_);
  label_.clear();
  correspondences_.clear();
  for (size_t i = 0; i < stacked.topics.size(); ++i) {
    const HeardTopic& topic = stacked.topics[i];
    label_.set({topic.robot, topic.id}, labels[i]);
    correspondences_.push_back({topic.robot, topic.id, labels[i]});
  }
  labels_ = summarize(stacked);
  giveNames(labels_, judgement, correspondences_);
  uint64_t sum = 0;
  for (const auto& [voice, shown] : shown_) sum += shown.hash * labelFactor(label_.of(voice));
  digest_ = mapDigest(sum, correspondences_);
}

std::vector<LabelSummary> FusedMap::summarize(const StackedTopics& stacked) const {
  std::map<world::GlobalLabel, LabelSummary> rows;
  for (const auto& [voice, shown] : shown_) {
    const world::GlobalLabel label = label_.of(voice);
    LabelSummary& row = rows[label];
    const world::Timestamp first_seen = shown.firsts.begin()->first;
    if (row.cells == 0)
      row = {.label = label, .name = "", .cells = 0, .robots = {}, .first_seen = first_seen};
    row.cells += shown.cells;
    row.first_seen = std::min(row.first_seen, first_seen);
    if (!containsRobot(row.robots, voice.first)) row.robots.push_back(voice.first);
  }
  for (const HeardTopic& topic : stacked.topics) {
    const auto row = rows.find(label_.of({topic.robot, topic.id}));
    if (row == rows.end() || topic.robot == kLibrary) continue;  // nobody saw it here
    if (!containsRobot(row->second.robots, topic.robot)) row->second.robots.push_back(topic.robot);
    row->second.first_seen = std::min(row->second.first_seen, topic.created);
  }
  std::vector<LabelSummary> summaries;
  for (auto& [label, row] : rows) {
    std::ranges::sort(row.robots);
    summaries.push_back(std::move(row));
  }
  return summaries;
}

std::map<BrickColumn, uint64_t> FusedMap::columnHashes() const {
  std::map<BrickColumn, uint64_t> hashes;
  for (const auto& [index, tile] : tiles_) {
    uint64_t sum = 0;
    for (const MapTile::Tally& tally : tile.tallies())
      sum += tally.hash * labelFactor(label_.of(tally.voice));
    if (!tile.tallies().empty()) hashes.try_emplace(hashes.end(), {index.x, index.y}, 0)->second += sum;
  }
  return hashes;
}

GlobalMap FusedMap::map() const {
  GlobalMap map;
  map.correspondences = correspondences_;
  map.labels = labels_;
  map.state_digest = state_digest_;
  map.cells.reserve(static_cast<size_t>(num_cells_));
  std::vector<ReadTile> row;
  for (auto at = tiles_.begin(); at != tiles_.end();) {
    row.clear();
    for (const int32_t x = at->first.x; at != tiles_.end() && at->first.x == x; ++at)
      row.emplace_back(at->first, at->second, label_);
    readRow(row, map.cells);
  }
  return map;
}

std::vector<GlobalCell> FusedMap::cellsIn(const std::set<BrickColumn>& columns) const {
  std::vector<GlobalCell> cells;
  std::vector<ReadTile> row;
  for (auto column = columns.begin(); column != columns.end();) {
    row.clear();
    for (const int32_t x = column->first; column != columns.end() && column->first == x; ++column) {
      const auto [_, y] = *column;
      for (auto at = tiles_.lower_bound({x, y, INT32_MIN});
           at != tiles_.end() && at->first.x == x && at->first.y == y; ++at)
        row.emplace_back(at->first, at->second, label_);
    }
    readRow(row, cells);
  }
  return cells;
}

}  // namespace shoal::mapping
