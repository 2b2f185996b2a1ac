// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/belief_pieces.h"

#include <algorithm>
#include <array>
#include <set>
#include <tuple>

#include "shoal/random.h"

namespace shoal::mapping {

namespace {

using Brick = std::array<int32_t, 3>;

std::vector<int32_t> groupSizes(const LocalBelief& belief) {
  std::vector<int32_t> sizes;
  for (const world::WordGroup& group : belief.groups) sizes.push_back(group.size);
  return sizes;
}

std::vector<Piece> topicPieces(const LocalBelief& belief) {
  const std::vector<int32_t> group_sizes = groupSizes(belief);
  std::vector<Piece> pieces;
  for (const BelievedTopic& topic : belief.topics) {
    pieces.push_back({.key = {belief.robot, PieceKind::kTopic, {number(topic.id), 0, 0}},
                      .version = belief.version,
                      .content = TopicPart{topic.created, topic.weight, group_sizes,
                                           quantize(topic.words, belief.detail)}});
  }
  return pieces;
}

// What is looked up by brick, cell after cell in their order: mostly the one of the cell before.
template <typename Value>
class ByBrick {
 public:
  Value& of(const world::CellIndex& cell) {
    const Brick brick = brickOf(cell);
    if (at_ == values_.end() || at_->first != brick) at_ = values_.try_emplace(brick).first;
    return at_->second;
  }
  std::map<Brick, Value>& values() { return values_; }

 private:
  std::map<Brick, Value> values_;
  std::map<Brick, Value>::iterator at_ = values_.end();
};

// The bricks whose keys `told` accepts, labels first.
template <typename IsTold>
std::vector<Piece> brickPieces(const LocalBelief& belief, IsTold is_told) {
  struct Parts {
    bool is_new = true, labels = false, certainties = false;
    BrickPart brick;
    CertaintyPart certainty;
  };
  const auto keyOf = [&](PieceKind kind, const Brick& brick) { return PieceKey{belief.robot, kind, brick}; };
  ByBrick<Parts> bricks;
  for (const BelievedCell& c : belief.cells) {
    Parts& parts = bricks.of(c.cell);
    if (parts.is_new) {
      const Brick brick = brickOf(c.cell);
      parts.is_new = false;
      parts.labels = is_told(keyOf(PieceKind::kBrick, brick));
      parts.certainties = is_told(keyOf(PieceKind::kCertainty, brick));
    }
    if (parts.labels) parts.brick.cells.push_back({c.cell, c.topic, c.seen});
    if (parts.certainties) {
      parts.certainty.cells.push_back(
          {c.cell, certaintySteps(c.certainty, belief.detail), surpriseSteps(c.surprise)});
    }
  }
  std::vector<Piece> pieces;
  for (auto& [brick, parts] : bricks.values()) {
    if (!parts.labels) continue;
    pieces.push_back({.key = keyOf(PieceKind::kBrick, brick),
                      .version = belief.version,
                      .content = std::move(parts.brick)});
  }
  for (auto& [brick, parts] : bricks.values()) {
    if (!parts.certainties) continue;
    pieces.push_back({.key = keyOf(PieceKind::kCertainty, brick),
                      .version = belief.version,
                      .content = std::move(parts.certainty)});
  }
  return pieces;
}

// What a brick holds, as sums over its cells: as good as the content itself for seeing that it has changed.
struct BrickSums {
  uint64_t labels = 0, certainties = 0;
  world::Timestamp seen;  // the latest
};

std::map<Brick, BrickSums> sumsOf(const LocalBelief& belief) {
  ByBrick<BrickSums> bricks;
  for (const BelievedCell& c : belief.cells) {
    BrickSums& sums = bricks.of(c.cell);
    const auto place = static_cast<uint64_t>((c.cell.x & 15) << 8 | (c.cell.y & 15) << 4 | (c.cell.z & 15));
    const auto topic = static_cast<uint64_t>(static_cast<uint32_t>(number(c.topic)));
    sums.labels += hashCombine(place << 32 | topic, static_cast<uint64_t>(c.seen.us));
    sums.certainties += mix64(place << 32 | uint64_t{certaintySteps(c.certainty, belief.detail)} << 8 |
                              surpriseSteps(c.surprise));
    sums.seen = std::max(sums.seen, c.seen);
  }
  return std::move(bricks.values());
}

uint64_t hashOf(Piece piece) {
  piece.version = {};
  return contentHash(piece);
}

}  // namespace

std::vector<Piece> wholePieces(const LocalBelief& belief) {
  std::vector<Piece> pieces = topicPieces(belief);
  for (Piece& piece : brickPieces(belief, [](const PieceKey&) { return true; }))
    pieces.push_back(std::move(piece));
  return pieces;
}

std::vector<Piece> BeliefChanges::changedTopics(const LocalBelief& belief) {
  std::vector<Piece> changed;
  std::set<PieceKey> there;
  for (Piece& piece : topicPieces(belief)) {
    there.insert(piece.key);
    Told& told = told_[piece.key];
    const uint64_t hash = hashOf(piece);
    if (told.hash == hash) continue;
    told.hash = hash;
    changed.push_back(std::move(piece));
  }
  const std::vector<int32_t> group_sizes = groupSizes(belief);
  for (auto& [key, told] : told_) {
    if (key.kind != PieceKind::kTopic || told.hash == 0 || there.contains(key)) continue;
    told.hash = 0;  // retired
    changed.push_back({.key = key, .version = belief.version, .content = TopicPart{{0}, 0, group_sizes, {}}});
  }
  std::ranges::sort(changed, {}, &Piece::key);
  return changed;
}

std::vector<Piece> BeliefChanges::update(const LocalBelief& belief, size_t most_bricks) {
  std::vector<Piece> changed = changedTopics(belief);

  struct Candidate {
    bool is_old = false;  // not seen since the last call
    int32_t since = 0;
    PieceKey key;
    uint64_t hash = 0;
  };
  std::vector<Candidate> candidates;
  world::Timestamp seen_until = seen_until_;
  const auto look = [&](PieceKind kind, const Brick& brick, uint64_t hash, bool is_old) {
    const PieceKey key{belief.robot, kind, brick};
    Told& told = told_[key];
    if (told.hash == hash) {
      told.since = kNotWaiting;
      return;
    }
    if (told.since == kNotWaiting) told.since = belief.version.observation;
    candidates.push_back({is_old, told.since, key, hash});
  };
  for (const auto& [brick, sums] : sumsOf(belief)) {
    const bool is_old = sums.seen <= seen_until_;
    look(PieceKind::kBrick, brick, sums.labels, is_old);
    look(PieceKind::kCertainty, brick, sums.certainties, is_old);
    seen_until = std::max(seen_until, sums.seen);
  }
  seen_until_ = seen_until;

  if (candidates.size() > most_bricks) {
    std::ranges::sort(candidates, {},
                      [](const Candidate& c) { return std::tuple(c.is_old, c.since, c.key); });
    candidates.resize(most_bricks);
  }
  std::set<PieceKey> told_now;
  for (const Candidate& c : candidates) {
    told_[c.key] = {c.hash, kNotWaiting};
    told_now.insert(c.key);
  }
  for (Piece& piece : brickPieces(belief, [&](const PieceKey& key) { return told_now.contains(key); }))
    changed.push_back(std::move(piece));
  return changed;
}

std::vector<BeliefChanges::Waiting> BeliefChanges::waiting() const {
  std::vector<Waiting> waiting;
  for (const auto& [key, told] : told_) {
    if (told.since != kNotWaiting) waiting.push_back({key, told.hash, told.since});
  }
  return waiting;
}

void BeliefChanges::restore(const LocalBelief& belief, const std::vector<Waiting>& waiting) {
  *this = {};
  update(belief);
  for (const Waiting& w : waiting) told_[w.key] = {w.told_hash, w.since};
}

}  // namespace shoal::mapping
