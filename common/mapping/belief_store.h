// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "shoal/mapping/piece.h"

namespace shoal::mapping {

/// What became of a piece offered to the store.
enum class Applied {
  kNew,        ///< the state changed
  kDuplicate,  ///< known already
  kOld,        ///< a newer version is held, or a newer epoch of the robot was heard
  kPending,    ///< of a newer version whose part 0 has not come yet
  kConflict,   ///< same key, version and part, other content: two processes with one robot id. Kept out.
  kRejected    ///< over a limit (too many robots, pieces or bytes). Kept out.
};

/// Caps that keep a hostile or broken peer from exhausting memory. Of `max_bytes` one half is set aside in
/// equal shares, one for each of `max_robots`, that nobody else can use up; the other half goes to who comes
/// first.
struct StoreLimits {
  int32_t max_robots = 255;  ///< as many as a tile of the fused map has room for
  int64_t max_pieces_per_robot = 1'000'000;
  int64_t max_edits = 10'000;
  int64_t max_bytes = int64_t{512} << 20;            ///< as heldBytes() counts
  int64_t max_bytes_per_robot = int64_t{128} << 20;  ///< three million cells
};

/// What holding a piece takes, about, with what nodes keep beside it to compare it: of its content, and for
/// being a piece at all. The same on every machine.
int64_t heldBytes(const Piece& piece);
inline constexpr int64_t kHeldBytesPerKey = 256;  ///< once for all parts and versions of a key

/// The replicated state: a join of versioned pieces. For each key it holds the newest version whose part 0
/// has been heard; parts of different versions never mix. Of each robot it holds one epoch, the newest it has
/// heard of: a robot that began anew has given its topics other meanings. The order in which pieces come, and
/// how often, does not matter.
class BeliefStore {
 public:
  explicit BeliefStore(StoreLimits limits = {}) : limits_(limits) {}

  Applied apply(const Piece& piece);

  /// The robot was heard to be in this epoch: what is held of older ones is void. Nothing happens when
  /// nothing was held of it.
  void noteEpoch(world::RobotId robot, int32_t epoch);

  /// Takes the usable parts of every piece, ascending by key, then part.
  template <typename Visitor>
  void visit(Visitor&& visitor) const {
    for (const auto& [key, slot] : slots_)
      for (const auto& [number, part] : slot.parts) visitor(part.piece);
  }

  /// The same of one robot, or of kOperators.
  template <typename Visitor>
  void visitOf(world::RobotId robot, Visitor&& visitor) const {
    for (auto at = slots_.lower_bound({robot, PieceKind{0}, {}});
         at != slots_.end() && at->first.robot == robot; ++at)
      for (const auto& [number, part] : at->second.parts) visitor(part.piece);
  }

  /// The same with contentHash() of each, at no cost: visitor(piece, hash).
  template <typename Visitor>
  void visitHashesOf(world::RobotId robot, Visitor&& visitor) const {
    for (auto at = slots_.lower_bound({robot, PieceKind{0}, {}});
         at != slots_.end() && at->first.robot == robot; ++at)
      for (const auto& [number, part] : at->second.parts) visitor(part.piece, part.hash);
  }

  /// The same of one key.
  template <typename Visitor>
  void visitOf(const PieceKey& key, Visitor&& visitor) const {
    const auto slot = slots_.find(key);
    if (slot == slots_.end()) return;
    for (const auto& [number, part] : slot->second.parts) visitor(part.piece);
  }

  /// The topics of all robots.
  template <typename Visitor>
  void visitTopics(Visitor&& visitor) const {
    for (const auto& [robot, sum] : sums_) {
      for (auto at = slots_.lower_bound({robot, PieceKind::kTopic, kLowestIndex});
           at != slots_.end() && at->first.robot == robot && at->first.kind == PieceKind::kTopic; ++at)
        for (const auto& [number, part] : at->second.parts) visitor(part.piece);
    }
  }

  /// Grows with every change of what visit() takes.
  uint64_t revision() const { return revision_; }

  /// Keys whose usable parts have changed since a revision, each once. What went because a robot began a new
  /// epoch is not among them: epochOf() tells.
  template <typename Visitor>
  void visitChanges(uint64_t since, Visitor&& visitor) const {
    for (auto at = changes_.upper_bound(since); at != changes_.end(); ++at) visitor(at->second);
  }
  /// A usable part of a piece; null when it is not held. Valid until the next apply().
  const Piece* find(const PieceKey& key, int32_t part) const;

  /// The newest epoch of a robot that was heard of; -1 when it never was.
  int32_t epochOf(world::RobotId robot) const;

  /// Robots that something is held of, ascending; last kOperators, when there are edits.
  std::vector<world::RobotId> robots() const;

  /// Digest of one robot's share of the state; 0 when nothing is held. A sum over parts, so a robot can keep
  /// its own without keeping the parts in order.
  uint64_t digestOf(world::RobotId robot) const;

  /// Digest of a robot's topics and settings: of what others need to know to judge their maps by.
  /// Cost: O(those).
  uint64_t learntDigestOf(world::RobotId robot) const;

  /// Digest of the whole state. When and from whom things were heard does not enter.
  uint64_t digest() const;

  size_t numPieces() const { return slots_.size(); }

  /// What is held, pieces that wait for their part 0 included; of all, and of one robot.
  int64_t numBytes() const { return bytes_; }
  int64_t numBytesOf(world::RobotId robot) const;

  /// A piece of the robot was refused for lack of room, and nothing of it has gone since: asking for what
  /// lacks is in vain.
  bool isFull(world::RobotId robot) const;

 private:
  static constexpr std::array<int32_t, 3> kLowestIndex{INT32_MIN, INT32_MIN, INT32_MIN};

  struct Part {
    Piece piece;
    uint64_t hash = 0;  // of its content
  };
  using Parts = std::map<int32_t, Part>;  // by number
  struct Slot {
    world::Version version{-1, -1};           // of the usable parts
    uint64_t changed = 0;                     // revision of their last change; 0 = none
    Parts parts;                              // usable
    std::map<world::Version, Parts> pending;  // newer, part 0 still lacking
  };
  struct RobotSum {
    uint64_t digest = 0;
    int64_t pieces = 0;
    int32_t epoch = -1;  // the newest heard of
    int64_t bytes = 0;
    bool full = false;
  };
  int64_t setAside() const { return limits_.max_bytes / 2 / std::max(limits_.max_robots, 1); }
  static int64_t sumOf(const Parts& parts);
  bool hasRoom(const RobotSum& sum, int64_t more) const;
  void charge(RobotSum& sum, int64_t more);
  int64_t bytesReplacedBy(const Piece& piece) const;
  static std::optional<Applied> compareToHeld(const Slot& slot, const Piece& piece);
  void beginEpoch(world::RobotId robot, RobotSum& sum, int32_t epoch);
  void promote(Slot& slot, world::Version version);
  void noteChange(const PieceKey& key, Slot& slot);

  StoreLimits limits_;
  std::map<PieceKey, Slot> slots_;
  std::map<world::RobotId, RobotSum> sums_;
  int64_t bytes_ = 0;
  int64_t shared_bytes_ = 0;  // of robots, what is beyond what is set aside for each
  uint64_t revision_ = 0;
  std::map<uint64_t, PieceKey> changes_;  // the last of every slot, by its revision
};

}  // namespace shoal::mapping
