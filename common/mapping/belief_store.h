// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
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
  kRejected    ///< over a limit (too many robots or pieces). Kept out.
};

/// Caps that keep a hostile or broken peer from exhausting memory.
struct StoreLimits {
  int32_t max_robots = 255;  ///< as many as a tile of the fused map has room for
  int64_t max_pieces_per_robot = 1'000'000;
  int64_t max_edits = 10'000;
};

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
      for (const auto& [part, piece] : slot.parts) visitor(piece);
  }

  /// The same of one robot, or of kOperators.
  template <typename Visitor>
  void visitOf(world::RobotId robot, Visitor&& visitor) const {
    for (auto at = slots_.lower_bound({robot, PieceKind{0}, {}});
         at != slots_.end() && at->first.robot == robot; ++at)
      for (const auto& [part, piece] : at->second.parts) visitor(piece);
  }

  /// The same of one key.
  template <typename Visitor>
  void visitOf(const PieceKey& key, Visitor&& visitor) const {
    const auto slot = slots_.find(key);
    if (slot == slots_.end()) return;
    for (const auto& [part, piece] : slot->second.parts) visitor(piece);
  }

  /// The topics of all robots.
  template <typename Visitor>
  void visitTopics(Visitor&& visitor) const {
    for (const auto& [robot, sum] : sums_) {
      for (auto at = slots_.lower_bound({robot, PieceKind::kTopic, kLowestIndex});
           at != slots_.end() && at->first.robot == robot && at->first.kind == PieceKind::kTopic; ++at)
        for (const auto& [part, piece] : at->second.parts) visitor(piece);
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

  /// Digest of the whole state. When and from whom things were heard does not enter.
  uint64_t digest() const;

  size_t numPieces() const { return slots_.size(); }

 private:
  static constexpr std::array<int32_t, 3> kLowestIndex{INT32_MIN, INT32_MIN, INT32_MIN};

  struct Slot {
    world::Version version{-1, -1};                              // of the usable parts
    uint64_t changed = 0;                                        // revision of their last change; 0 = none
    std::map<int32_t, Piece> parts;                              // usable, by part number
    std::map<world::Version, std::map<int32_t, Piece>> pending;  // newer, part 0 still lacking
  };
  struct RobotSum {
    uint64_t digest = 0;
    int64_t pieces = 0;
    int32_t epoch = -1;  // the newest heard of
  };
  void beginEpoch(world::RobotId robot, RobotSum& sum, int32_t epoch);
  void promote(Slot& slot, world::Version version);
  void noteChange(const PieceKey& key, Slot& slot);

  StoreLimits limits_;
  std::map<PieceKey, Slot> slots_;
  std::map<world::RobotId, RobotSum> sums_;
  uint64_t revision_ = 0;
  std::map<uint64_t, PieceKey> changes_;  // the last of every slot, by its revision
};

}  // namespace shoal::mapping
