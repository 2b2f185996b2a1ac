// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/belief_pieces.h"

#include <algorithm>
#include <array>
#include <set>

#include "shoal/random.h"

namespace shoal::mapping {

namespace {

std::vector<int32_t> groupSizes(const LocalBelief& belief) {
  std::vector<int32_t> sizes;
  for (const world::WordGroup& group : belief.groups) sizes.push_back(group.size);
  return sizes;
}

PieceKey topicKey(const LocalBelief& belief, const BelievedTopic& topic) {
  return {belief.robot, PieceKind::kTopic, {number(topic.id), 0, 0}};
}

Piece topicPiece(const LocalBelief& belief, const BelievedTopic& topic) {
  return {.key = topicKey(belief, topic),
          .version = belief.version,
          .content = TopicPart{topic.created, topic.weight, groupSizes(belief),
                               quantize(topic.words, belief.detail)}};
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
  typename std::map<Brick, Value>::iterator at_ = values_.end();
};

BrickPart labelsOf(const std::vector<BelievedCell>& cells) {
  BrickPart part;
  part.cells.reserve(cells.size());
  for (const BelievedCell& c : cells) part.cells.push_back({c.cell, c.topic, c.seen});
  return part;
}

CertaintyPart certaintiesOf(const std::vector<BelievedCell>& cells, Detail detail) {
  CertaintyPart part;
  part.cells.reserve(cells.size());
  for (const BelievedCell& c : cells)
    part.cells.push_back({c.cell, certaintySteps(c.certainty, detail), surpriseSteps(c.surprise)});
  return part;
}

// A whole belief, in bricks.
class WholeBricks final : public BelievedBricks {
 public:
  explicit WholeBricks(const LocalBelief& belief) {
    ByBrick<std::vector<BelievedCell>> bricks;
    for (const BelievedCell& c : belief.cells) bricks.of(c.cell).push_back(c);
    bricks_ = std::move(bricks.values());
  }
  std::vector<BelievedCell> cellsOf(const Brick& brick) const override {
    const auto found = bricks_.find(brick);
    return found == bricks_.end() ? std::vector<BelievedCell>{} : found->second;
  }
  std::optional<Brick> after(const std::optional<Brick>& brick) const override {
    const auto next = brick ? bricks_.upper_bound(*brick) : bricks_.begin();
    if (next == bricks_.end()) return std::nullopt;
    return next->first;
  }
  const std::map<Brick, std::vector<BelievedCell>>& all() const { return bricks_; }

 private:
  std::map<Brick, std::vector<BelievedCell>> bricks_;
};

// What a brick holds, as sums over its cells, of labels and of certainties: as good as the content itself for
// seeing that it has changed.
using BrickSums = std::array<uint64_t, 2>;

uint64_t sumOf(PieceKind kind, const BrickSums& sums) { return sums[kind == PieceKind::kBrick ? 0 : 1]; }

BrickSums sumsOf(const std::vector<BelievedCell>& cells, Detail detail) {
  BrickSums sums{};
  for (const BelievedCell& c : cells) {
    const auto place = static_cast<uint64_t>((c.cell.x & 15) << 8 | (c.cell.y & 15) << 4 | (c.cell.z & 15));
    const auto topic = static_cast<uint64_t>(static_cast<uint32_t>(number(c.topic)));
    sums[0] += hashCombine(place << 32 | topic, static_cast<uint64_t>(c.seen.us));
    sums[1] +=
        mix64(place << 32 | uint64_t{certaintySteps(c.certainty, detail)} << 8 | surpriseSteps(c.surprise));
  }
  return sums;
}

Piece brickPiece(const LocalBelief& belief, const PieceKey& key, const std::vector<BelievedCell>& cells) {
  Piece piece{.key = key, .version = belief.version, .content = {}};
  if (key.kind == PieceKind::kBrick) {
    piece.content = labelsOf(cells);
  } else {
    piece.content = certaintiesOf(cells, belief.detail);
  }
  return piece;
}

constexpr std::array kBrickKinds = {PieceKind::kBrick, PieceKind::kCertainty};

uint64_t hashOf(Piece piece) {
  piece.version = {};
  return contentHash(piece);
}

// Adjoining bricks have different turns, and so have topics one after the other.
bool isTurn(const BeliefChanges::Turn& turn, const Brick& index) {
  const int64_t number = index[0] + int64_t{2} * index[1] + int64_t{3} * index[2];
  return (number % turn.of + turn.of) % turn.of == turn.number;
}

}  // namespace

std::vector<Piece> wholePieces(const LocalBelief& belief) {
  std::vector<Piece> pieces;
  for (const BelievedTopic& topic : belief.topics) pieces.push_back(topicPiece(belief, topic));
  const WholeBricks bricks(belief);
  for (const PieceKind kind : kBrickKinds) {
    for (const auto& [brick, cells] : bricks.all())
      pieces.push_back(brickPiece(belief, {belief.robot, kind, brick}, cells));
  }
  return pieces;
}

std::vector<Piece> BeliefChanges::changedTopics(const LocalBelief& belief, const Turn& turn) {
  std::vector<Piece> changed;
  std::set<PieceKey> there;
  for (const BelievedTopic& topic : belief.topics) {
    const PieceKey key = topicKey(belief, topic);
    there.insert(key);
    if (!isTurn(turn, key.index)) continue;
    Piece piece = topicPiece(belief, topic);
    Told& told = told_[key];
    const uint64_t hash = hashOf(piece);
    if (told.hash == hash) continue;
    told.hash = hash;
    changed.push_back(std::move(piece));
  }
  const std::vector<int32_t> group_sizes = groupSizes(belief);
  for (auto& [key, told] : told_) {
    if (key.kind != PieceKind::kTopic) break;  // topics come first
    if (told.hash == 0 || there.contains(key) || !isTurn(turn, key.index)) continue;
    told.hash = 0;  // retired
    changed.push_back({.key = key, .version = belief.version, .content = TopicPart{{0}, 0, group_sizes, {}}});
  }
  std::ranges::sort(changed, {}, &Piece::key);
  return changed;
}

// One look at some of the bricks.
class BeliefChanges::Round {
 public:
  Round(BeliefChanges& changes, const LocalBelief& outline, const BelievedBricks& bricks)
      : changes_(changes), outline_(outline), bricks_(bricks) {}

  // Finds out whether a brick has changed. Returns its number of cells, 0 when it was looked at before.
  size_t look(const Brick& brick) {
    const auto [looked, is_first] = looked_.try_emplace(brick);
    if (!is_first) return 0;
    looked->second.cells = bricks_.cellsOf(brick);
    looked->second.sums = sumsOf(looked->second.cells, outline_.detail);
    for (const PieceKind kind : kBrickKinds) {
      const PieceKey key{outline_.robot, kind, brick};
      Told& told = changes_.told_[key];
      const bool differs = told.hash != sumOf(kind, looked->second.sums);
      if (differs == (told.since != kNotWaiting)) continue;
      if (!differs) changes_.waiting_.erase({told.since, key});
      told.since = differs ? outline_.version.observation : kNotWaiting;
      if (differs) changes_.waiting_.emplace(told.since, key);
    }
    return looked->second.cells.size();
  }

  // Of those that were found to differ at most so many, as if told. First those of `first`, which were looked
  // at, then those that have waited longest; ascending.
  std::set<PieceKey> choose(const std::set<Brick>& first, size_t most) {
    std::set<std::pair<int32_t, PieceKey>> waiting;
    for (const Brick& brick : first) {
      for (const PieceKind kind : kBrickKinds) {
        const PieceKey key{outline_.robot, kind, brick};
        const int32_t since = changes_.told_[key].since;
        if (since != kNotWaiting) waiting.emplace(since, key);
      }
    }
    std::set<PieceKey> chosen;
    for (const auto& [since, key] : waiting) {
      if (chosen.size() < most) choose(key, chosen);
    }
    while (chosen.size() < most && !changes_.waiting_.empty()) {
      const PieceKey key = changes_.waiting_.begin()->second;
      look(key.index);  // it may be again as it was told, and waits no longer
      if (changes_.told_[key].since != kNotWaiting) choose(key, chosen);
    }
    return chosen;
  }

  // As they were when looked at.
  const std::vector<BelievedCell>& cellsOf(const Brick& brick) const { return looked_.at(brick).cells; }

 private:
  struct Looked {
    std::array<uint64_t, 2> sums{};
    std::vector<BelievedCell> cells;
  };

  void choose(const PieceKey& key, std::set<PieceKey>& chosen) {
    Told& told = changes_.told_[key];
    changes_.waiting_.erase({told.since, key});
    told = {sumOf(key.kind, looked_.at(key.index).sums), kNotWaiting};
    chosen.insert(key);
  }

  BeliefChanges& changes_;
  const LocalBelief& outline_;
  const BelievedBricks& bricks_;
  std::map<Brick, Looked> looked_;
};

std::vector<Piece> BeliefChanges::update(const LocalBelief& belief, size_t most_bricks) {
  const WholeBricks bricks(belief);
  std::set<Brick> seen;
  world::Timestamp seen_until = seen_until_;
  for (const auto& [brick, cells] : bricks.all()) {
    for (const BelievedCell& c : cells) {
      if (c.seen > seen_until_) seen.insert(brick);
      seen_until = std::max(seen_until, c.seen);
    }
  }
  seen_until_ = seen_until;
  return update(belief, bricks, seen, most_bricks, kAll);
}

std::vector<Piece> BeliefChanges::update(const LocalBelief& outline, const BelievedBricks& bricks,
                                         const std::set<Brick>& seen, size_t most_bricks, size_t most_cells,
                                         const Turn& turn) {
  std::vector<Piece> changed = changedTopics(outline, turn);
  Round round(*this, outline, bricks);
  seen_.insert(seen.begin(), seen.end());
  std::set<Brick> due;
  std::erase_if(seen_, [&](const Brick& brick) { return isTurn(turn, brick) && due.insert(brick).second; });
  for (const Brick& brick : due) round.look(brick);
  const std::optional<Brick> begun_at = looked_until_;
  bool has_wrapped = false;
  for (size_t num_looked = 0; num_looked < most_cells;) {
    std::optional<Brick> next = bricks.after(looked_until_);
    if (!next && !has_wrapped && begun_at) {
      has_wrapped = true;
      next = bricks.after(std::nullopt);
    }
    if (!next || (has_wrapped && *next > *begun_at)) break;
    num_looked += round.look(*next);
    looked_until_ = next;
  }
  const std::set<PieceKey> told = round.choose(due, most_bricks);
  for (const PieceKey& key : told) changed.push_back(brickPiece(outline, key, round.cellsOf(key.index)));
  return changed;
}

std::vector<BeliefChanges::Waiting> BeliefChanges::waiting() const {
  std::vector<Waiting> waiting;
  for (const auto& [since, key] : waiting_) waiting.push_back({key, told_.at(key).hash, since});
  std::ranges::sort(waiting, {}, &Waiting::key);
  return waiting;
}

std::vector<BeliefChanges::Waiting> BeliefChanges::waiting(const LocalBelief& outline,
                                                           const BelievedBricks& bricks) const {
  std::vector<Waiting> waiting;
  std::set<PieceKey> there;
  for (const BelievedTopic& topic : outline.topics) {
    const PieceKey key = topicKey(outline, topic);
    there.insert(key);
    const auto found = told_.find(key);
    const uint64_t told_hash = found == told_.end() ? 0 : found->second.hash;
    if (told_hash != hashOf(topicPiece(outline, topic))) waiting.push_back({key, told_hash, kNotWaiting});
  }
  for (const auto& [key, told] : told_) {
    if (key.kind != PieceKind::kTopic) break;  // topics come first
    if (told.hash != 0 && !there.contains(key)) waiting.push_back({key, told.hash, kNotWaiting});
  }
  for (std::optional<Brick> brick = bricks.after({}); brick; brick = bricks.after(brick)) {
    const BrickSums sums = sumsOf(bricks.cellsOf(*brick), outline.detail);
    for (const PieceKind kind : kBrickKinds) {
      const PieceKey key{outline.robot, kind, *brick};
      const auto found = told_.find(key);
      const Told told = found == told_.end() ? Told{} : found->second;
      if (told.hash != sumOf(kind, sums) || told.since != kNotWaiting)
        waiting.push_back({key, told.hash, told.since});
    }
  }
  std::ranges::sort(waiting, {}, &Waiting::key);
  return waiting;
}

void BeliefChanges::restore(const LocalBelief& belief, const std::vector<Waiting>& waiting,
                            const std::optional<Brick>& looked_until, const std::set<Brick>& seen) {
  *this = {};
  update(belief);
  looked_until_ = looked_until;
  seen_ = seen;
  for (const Waiting& w : waiting) {
    told_[w.key] = {w.told_hash, w.since};
    if (w.since != kNotWaiting) waiting_.emplace(w.since, w.key);
  }
}

}  // namespace shoal::mapping
