// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/piece.h"

#include <bit>

#include "shoal/random.h"

namespace shoal::mapping {
namespace {

class Hasher {
 public:
  void add(int64_t value) { hash_ = hashCombine(hash_, static_cast<uint64_t>(value)); }
  void add(const world::CellIndex& c) {
    add(c.x);
    add(c.y);
    add(c.z);
  }
  void operator()(const TopicPart& part) {
    add(part.created.us);
    add(part.weight);
    add(std::ssize(part.group_sizes));
    for (const int32_t size : part.group_sizes) add(size);
    for (const auto& [word, count] : part.words) {
      add(word);
      add(count);
    }
  }
  void operator()(const BrickPart& part) {
    for (const BrickCell& c : part.cells) {
      add(c.cell);
      add(number(c.topic));
      add(c.seen.us);
    }
  }
  void operator()(const CertaintyPart& part) {
    for (const CertaintyCell& c : part.cells) {
      add(c.cell);
      add(c.steps);
      add(c.surprise);
    }
  }
  void operator()(const PicturePart& part) {
    add(part.cell);
    add(part.seen.us);
    add(std::ssize(part.layer));
    for (const uint8_t byte : part.layer) add(byte);
  }
  void operator()(const SettingsPart& part) {
    add(static_cast<int64_t>(part.words));
    add(static_cast<int64_t>(part.hyperparameters));
    add(std::bit_cast<int64_t>(part.cell_size_m));
  }
  void operator()(const Edit& edit) { add(static_cast<int64_t>(contentHash(edit))); }
  uint64_t hash() const { return hash_; }

 private:
  uint64_t hash_ = 0;
};

}  // namespace

uint64_t contentHash(const Piece& piece) {
  Hasher hasher;
  hasher.add(number(piece.key.robot));
  hasher.add(static_cast<int64_t>(piece.key.kind));
  for (const int32_t i : piece.key.index) hasher.add(i);
  hasher.add(piece.version.epoch);
  hasher.add(piece.version.observation);
  hasher.add(piece.part);
  hasher.add(piece.num_parts);
  std::visit(hasher, piece.content);
  return hasher.hash();
}

PieceKey keyOf(const Edit& edit) {
  const uint64_t hash = contentHash(edit);
  return {kOperators,
          PieceKind::kEdit,
          {edit.id.counter, static_cast<int32_t>(hash >> 32), static_cast<int32_t>(hash & 0xffffffffu)}};
}

Piece pieceOf(const Edit& edit) { return {keyOf(edit), {}, 0, 1, edit}; }

Piece pieceOf(world::RobotId robot, int32_t epoch, const SettingsPart& settings) {
  return {{robot, PieceKind::kSettings, {}}, {epoch, 0}, 0, 1, settings};
}

}  // namespace shoal::mapping
