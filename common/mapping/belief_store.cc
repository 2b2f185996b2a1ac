// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/belief_store.h"

#include <algorithm>

#include "shoal/random.h"

namespace shoal::mapping {
namespace {

// Versions that wait for their part 0. More than a few means a peer that never sends it.
constexpr size_t kMaxPendingVersions = 8;

// Of a part, whatever it holds: itself, its nodes in maps here, its leaf and name in digest trees.
constexpr int64_t kHeldBytesPerPart = 320;

template <typename T>
int64_t sizeOf(const std::vector<T>& list, int64_t each) {
  return static_cast<int64_t>(list.size()) * each;
}

int64_t contentBytes(const TopicPart& part) { return sizeOf(part.group_sizes, 4) + sizeOf(part.words, 8); }
int64_t contentBytes(const BrickPart& part) { return sizeOf(part.cells, 24); }
int64_t contentBytes(const CertaintyPart& part) { return sizeOf(part.cells, 16); }
int64_t contentBytes(const PicturePart& part) { return sizeOf(part.layer, 1); }
int64_t contentBytes(const SettingsPart&) { return 0; }
int64_t contentBytes(const Edit&) { return 256; }  // names are short

}  // namespace

int64_t heldBytes(const Piece& piece) {
  return kHeldBytesPerPart +
         std::visit([](const auto& content) { return contentBytes(content); }, piece.content);
}

int64_t BeliefStore::sumOf(const Parts& parts) {
  int64_t bytes = 0;
  for (const auto& [number, part] : parts) bytes += heldBytes(part.piece);
  return bytes;
}

// Within what is set aside for it a robot has room always. Beyond, together with all others.
bool BeliefStore::hasRoom(const RobotSum& sum, int64_t more) const {
  const int64_t bytes = sum.bytes + more;
  if (bytes > limits_.max_bytes_per_robot) return false;
  const auto shared = [this](int64_t held) { return std::max<int64_t>(held - setAside(), 0); };
  const int64_t most = limits_.max_bytes - limits_.max_robots * setAside();
  return shared(bytes) == 0 || shared_bytes_ - shared(sum.bytes) + shared(bytes) <= most;
}

void BeliefStore::charge(RobotSum& sum, int64_t more) {
  shared_bytes_ -= std::max<int64_t>(sum.bytes - setAside(), 0);
  sum.bytes += more;
  bytes_ += more;
  shared_bytes_ += std::max<int64_t>(sum.bytes - setAside(), 0);
  if (more < 0) sum.full = false;
}

// What goes when a piece comes that is news: all that is older than a new version's part 0.
int64_t BeliefStore::bytesReplacedBy(const Piece& piece) const {
  const auto slot = slots_.find(piece.key);
  if (slot == slots_.end() || piece.part != 0 || piece.version == slot->second.version) return 0;
  int64_t bytes = sumOf(slot->second.parts);
  for (const auto& [version, parts] : slot->second.pending)
    if (version < piece.version) bytes += sumOf(parts);
  return bytes;
}

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
  if (found != slots_.end()) {
    if (piece.version < found->second.version) return Applied::kOld;
    if (const auto known = compareToHeld(found->second, piece)) return *known;
  }
  const bool is_new_key = found == slots_.end();
  const int64_t most = robot == kOperators ? limits_.max_edits : limits_.max_pieces_per_robot;
  if (is_new_key && sum->second.pieces >= most) return Applied::kRejected;
  const int64_t bytes = heldBytes(piece) + (is_new_key ? kHeldBytesPerKey : 0);
  if (!hasRoom(sum->second, bytes) && !hasRoom(sum->second, bytes - bytesReplacedBy(piece))) {
    sum->second.full = true;
    return Applied::kRejected;
  }
  if (is_new_key) {
    ++sum->second.pieces;
    found = slots_.emplace(piece.key, Slot{}).first;
  }
  charge(sum->second, bytes);
  Slot& slot = found->second;
  auto& parts = piece.version == slot.version ? slot.parts : slot.pending[piece.version];
  const uint64_t hash = contentHash(piece);
  parts.emplace(piece.part, Part{piece, hash});
  if (piece.version == slot.version) {
    sum->second.digest += hash;
    noteChange(piece.key, slot);
    return Applied::kNew;
  }
  if (piece.part != 0) {
    if (slot.pending.size() > kMaxPendingVersions) {
      charge(sum->second, -sumOf(slot.pending.begin()->second));
      slot.pending.erase(slot.pending.begin());
    }
    return Applied::kPending;
  }
  promote(slot, piece.version);
  noteChange(piece.key, slot);
  return Applied::kNew;
}

// Whether a piece, no older than what the slot holds, is held already or contradicts what is; else nothing.
std::optional<Applied> BeliefStore::compareToHeld(const Slot& slot, const Piece& piece) {
  const auto waiting = slot.pending.find(piece.version);
  if (piece.version != slot.version && waiting == slot.pending.end()) return std::nullopt;
  const auto& parts = piece.version == slot.version ? slot.parts : waiting->second;
  if (!parts.empty() && parts.begin()->second.piece.num_parts != piece.num_parts) return Applied::kConflict;
  const auto held = parts.find(piece.part);
  if (held == parts.end()) return std::nullopt;
  return held->second.piece == piece ? Applied::kDuplicate : Applied::kConflict;
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
  charge(sum, -sum.bytes);
  sum = {.epoch = epoch};
}

// Part 0 of a newer version has come: it is what the slot now holds, and all that is older goes.
void BeliefStore::promote(Slot& slot, world::Version version) {
  const auto newer = slot.pending.find(version);
  RobotSum& sum = sums_.at(newer->second.begin()->second.piece.key.robot);
  for (const auto& [number, part] : slot.parts) sum.digest -= part.hash;
  int64_t gone = sumOf(slot.parts);
  for (auto older = slot.pending.begin(); older != newer; ++older) gone += sumOf(older->second);
  charge(sum, -gone);
  slot.version = version;
  slot.parts = std::move(newer->second);
  for (const auto& [number, part] : slot.parts) sum.digest += part.hash;
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
  return held == slot->second.parts.end() ? nullptr : &held->second.piece;
}

int32_t BeliefStore::epochOf(world::RobotId robot) const {
  const auto sum = sums_.find(robot);
  return sum == sums_.end() ? -1 : sum->second.epoch;
}

int64_t BeliefStore::numBytesOf(world::RobotId robot) const {
  const auto sum = sums_.find(robot);
  return sum == sums_.end() ? 0 : sum->second.bytes;
}

bool BeliefStore::isFull(world::RobotId robot) const {
  const auto sum = sums_.find(robot);
  return sum != sums_.end() && sum->second.full;
}

uint64_t BeliefStore::digestOf(world::RobotId robot) const {
  const auto sum = sums_.find(robot);
  return sum == sums_.end() ? 0 : sum->second.digest;
}

uint64_t BeliefStore::learntDigestOf(world::RobotId robot) const {
  uint64_t digest = 0;
  for (const PieceKind kind : {PieceKind::kTopic, PieceKind::kSettings}) {
    for (auto at = slots_.lower_bound({robot, kind, kLowestIndex});
         at != slots_.end() && at->first.robot == robot && at->first.kind == kind; ++at)
      for (const auto& [number, part] : at->second.parts) digest += part.hash;
  }
  return digest;
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
