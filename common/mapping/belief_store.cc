// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/belief_store.h"

#include <algorithm>

#include "shoal/random.h"

namespace shoal::mapping {
namespace {

// Versions that wait for their part 0. More than a few means a peer that never sends it.
constexpr size_t kMaxPendingVersions = 8;

}  // namespace

Applied BeliefStore::apply(const Piece& piece) {
  const world::RobotId robot = piece.key.robot;
  auto sum = sums_.find(robot);
  if (sum == sums_.end()) {
    if (std::ssize(sums_) >= limits_.max_robots) return Applied::kRejected;
    sum = sums_.emplace(robot, RobotSum{}).first;
  }
  if (piece.version.epoch < sum->second.epoch) return Applied::kOld;
  if (piece.version.epoch > sum->second.epoch) beginEpoch(robot, sum->second, piece.version.epoch);
  auto found = slots_.find(piece.key);
  if (found == slots_.end()) {
    const int64_t most = robot == kOperators ? limits_.max_edits : limits_.max_pieces_per_robot;
    if (sum->second.pieces >= most) return Applied::kRejected;
    ++sum->second.pieces;
    found = slots_.emplace(piece.key, Slot{}).first;
  }
  Slot& slot = found->second;
  if (piece.version < slot.version) return Applied::kOld;

  auto& parts = piece.version == slot.version ? slot.parts : slot.pending[piece.version];
  if (!parts.empty() && parts.begin()->second.num_parts != piece.num_parts) return Applied::kConflict;
  const auto [held, inserted] = parts.emplace(piece.part, piece);
  if (!inserted) return held->second == piece ? Applied::kDuplicate : Applied::kConflict;
  if (piece.version == slot.version) {
    sum->second.digest += contentHash(piece);
    noteChange(piece.key, slot);
    return Applied::kNew;
  }
  if (piece.part != 0) {
    if (slot.pending.size() > kMaxPendingVersions) slot.pending.erase(slot.pending.begin());
    return Applied::kPending;
  }
  promote(slot, piece.version);
  noteChange(piece.key, slot);
  return Applied::kNew;
}

void BeliefStore::noteEpoch(world::RobotId robot, int32_t epoch) {
  const auto sum = sums_.find(robot);
  if (sum != sums_.end() && sum->second.epoch < epoch) beginEpoch(robot, sum->second, epoch);
}

// All that the robot said in older epochs goes.
void BeliefStore::beginEpoch(world::RobotId robot, RobotSum& sum, int32_t epoch) {
  const auto first =
      std::ranges::find_if(slots_, [&](const auto& slot) { return slot.first.robot == robot; });
  const auto last = std::find_if(first, slots_.end(), [&](const auto& s) { return s.first.robot != robot; });
  for (auto slot = first; slot != last; ++slot) changes_.erase(slot->second.changed);
  slots_.erase(first, last);
  ++revision_;
  sum = {0, 0, epoch};
}

// Part 0 of a newer version has come: it is what the slot now holds, and all that is older goes.
void BeliefStore::promote(Slot& slot, world::Version version) {
  const auto newer = slot.pending.find(version);
  RobotSum& sum = sums_.at(newer->second.begin()->second.key.robot);
  for (const auto& [part, piece] : slot.parts) sum.digest -= contentHash(piece);
  slot.version = version;
  slot.parts = std::move(newer->second);
  for (const auto& [part, piece] : slot.parts) sum.digest += contentHash(piece);
  slot.pending.erase(slot.pending.begin(), slot.pending.upper_bound(version));
}

void BeliefStore::noteChange(const PieceKey& key, Slot& slot) {
  changes_.erase(slot.changed);
  slot.changed = ++revision_;
  changes_.emplace_hint(changes_.end(), slot.changed, key);
}

std::vector<world::RobotId> BeliefStore::robots() const {
  std::vector<world::RobotId> robots;
  for (const auto& [robot, sum] : sums_) robots.push_back(robot);
  return robots;
}

const Piece* BeliefStore::find(const PieceKey& key, int32_t part) const {
  const auto slot = slots_.find(key);
  if (slot == slots_.end()) return nullptr;
  const auto held = slot->second.parts.find(part);
  return held == slot->second.parts.end() ? nullptr : &held->second;
}

int32_t BeliefStore::epochOf(world::RobotId robot) const {
  const auto sum = sums_.find(robot);
  return sum == sums_.end() ? -1 : sum->second.epoch;
}

uint64_t BeliefStore::digestOf(world::RobotId robot) const {
  const auto sum = sums_.find(robot);
  return sum == sums_.end() ? 0 : sum->second.digest;
}

uint64_t BeliefStore::digest() const {
  uint64_t digest = 0;
  for (const auto& [robot, sum] : sums_) {
    if (sum.digest == 0) continue;  // nothing usable yet
    digest = hashCombine(hashCombine(digest, static_cast<uint64_t>(number(robot))), sum.digest);
  }
  return digest;
}

}  // namespace shoal::mapping
