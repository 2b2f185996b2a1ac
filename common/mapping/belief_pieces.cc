// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/belief_pieces.h"

#include <algorithm>

namespace shoal::mapping {

namespace {

std::vector<int32_t> groupSizes(const LocalBelief& belief) {
  std::vector<int32_t> sizes;
  for (const world::WordGroup& group : belief.groups) sizes.push_back(group.size);
  return sizes;
}

}  // namespace

std::vector<Piece> wholePieces(const LocalBelief& belief) {
  std::vector<Piece> pieces;
  const std::vector<int32_t> group_sizes = groupSizes(belief);
  for (const BelievedTopic& topic : belief.topics) {
    pieces.push_back({.key = {belief.robot, PieceKind::kTopic, {number(topic.id), 0, 0}},
                      .version = belief.version,
                      .content = TopicPart{topic.created, topic.weight, group_sizes,
                                           quantize(topic.words, belief.detail)}});
  }
  std::map<std::array<int32_t, 3>, BrickPart> bricks;
  std::map<std::array<int32_t, 3>, CertaintyPart> certainties;
  for (const BelievedCell& c : belief.cells) {
    bricks[brickOf(c.cell)].cells.push_back({c.cell, c.topic, c.seen});
    certainties[brickOf(c.cell)].cells.push_back(
        {c.cell, certaintySteps(c.certainty, belief.detail), surpriseSteps(c.surprise)});
  }
  for (auto& [index, part] : bricks) {
    pieces.push_back({.key = {belief.robot, PieceKind::kBrick, index},
                      .version = belief.version,
                      .content = std::move(part)});
  }
  for (auto& [index, part] : certainties) {
    pieces.push_back({.key = {belief.robot, PieceKind::kCertainty, index},
                      .version = belief.version,
                      .content = std::move(part)});
  }
  return pieces;
}

std::vector<Piece> BeliefChanges::update(const LocalBelief& belief) {
  std::vector<Piece> changed;
  std::map<PieceKey, uint64_t> now;
  for (Piece& piece : wholePieces(belief)) {
    Piece unversioned = piece;
    unversioned.version = {};
    const uint64_t hash = contentHash(unversioned);
    const auto before = content_hash_.find(piece.key);
    now.emplace(piece.key, hash);
    if (before == content_hash_.end() || before->second != hash) changed.push_back(std::move(piece));
  }
  const std::vector<int32_t> group_sizes = groupSizes(belief);
  for (const auto& [key, hash] : content_hash_) {
    if (key.kind != PieceKind::kTopic || now.contains(key)) continue;
    now.emplace(key, 0);
    if (hash == 0) continue;  // retired already
    changed.push_back({.key = key, .version = belief.version, .content = TopicPart{{0}, 0, group_sizes, {}}});
  }
  std::ranges::sort(changed, {}, &Piece::key);
  content_hash_ = std::move(now);
  return changed;
}

}  // namespace shoal::mapping
