// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "shoal/comms/digest_tree.h"
#include "shoal/comms/repair_talk.h"
#include "shoal/random.h"

namespace shoal::comms {

/// What a node holds, as anti-entropy sees it. Shares are numbers: here, robots.
class Holdings {
 public:
  virtual ~Holdings() = default;

  /// What is held of a share, now. Valid until the next call.
  virtual const DigestTree& treeOf(int32_t share) = 0;

  /// True while somebody is known to hold something else of a share, and this node should care.
  virtual bool isDoubted(int32_t share) = 0;

  /// While the owner of a share has not yet said all of it for the first time, bytes that were missed of what
  /// it has said: what else lacks will come. Else nothing.
  virtual std::optional<int64_t> missed(int32_t share) = 0;
};

struct AntiEntropyOptions {
  uint64_t seed = 0;                      ///< of the back-offs: another for every node
  std::optional<int32_t> own_share = {};  ///< that of this node: it answers first
  int64_t unit_us = 1'000'000;            ///< what back-offs are multiples of: no less than a datagram takes
  int64_t patience_us = 0;                ///< before a first question about a share
  size_t max_talk_bytes = 500;            ///< of one message, encoded, >= 200
  int64_t talk_bytes_per_s = 250;         ///< 0 = unlimited
};

/// Finds out what a node lacks and gets it, and tells others what they lack.
///
/// Who doubts a share says what it holds of it: digests of the sixteen branches of its tree, or all keys and
/// versions when they are few. Whoever holds something else there answers one level down, until both see
/// which pieces differ; who lacks one asks for it, who sees that an asker lacks one says it. Everything is
/// said to all, so one answer and one repair serve everybody: all wait a random time first (the owner of the
/// share the shortest), and who hears another say it keeps silent (Floyd et al., SIGCOMM 1995). Losses are
/// healed by asking again, less and less often while nothing comes of it.
///
/// Pieces are opaque. Deterministic given the seed and the order of calls; bounded memory whatever is heard.
/// Times are mission time, microseconds.
class AntiEntropy {
 public:
  using PieceName = std::pair<int32_t, uint64_t>;  ///< share, key
  static constexpr int64_t kNever = INT64_MAX;

  /// `holdings` outlives it.
  AntiEntropy(const AntiEntropyOptions& options, Holdings& holdings);

  /// Somebody seems to hold something else of a share.
  void doubt(int32_t share, int64_t now_us);

  /// What another node said.
  void hear(const RepairTalk& talk, int64_t now_us);

  /// A piece was heard, in this version; `repaired` when not by its owner for the first time.
  void heard(const PieceName& piece, uint64_t version, bool repaired, int64_t now_us);

  /// A piece is wanted in this version or a newer one: it is asked for, a few times, until it is heard. Also
  /// one that nobody is known to hold: its owner may make it.
  void want(const PieceName& piece, uint64_t version, int64_t now_us);

  /// What to say now, if anything; it counts as said.
  /// Cost: O(what waits), at most 10^4.
  std::optional<RepairTalk> nextTalk(int64_t now_us);

  /// A piece to say for others now, if any; it counts as said.
  std::optional<PieceName> nextRepair(int64_t now_us);

  /// When these may have more, > now_us; or kNever.
  int64_t nextTalkDue(int64_t now_us) const;
  int64_t nextRepairDue(int64_t now_us) const;

  size_t numWanted() const { return wanted_.size(); }
  size_t numRepairs() const { return repairs_.size(); }

 private:
  struct Question {
    int64_t due_us = 0;
    int attempts = 0;
    uint64_t state = 0;  // at the last attempt: what was held, or missed
  };
  struct Answer {
    int64_t due_us = 0;
    bool asks = false;
  };
  struct Wanted {
    uint64_t version = 0;
    int64_t due_us = 0;
    int attempts = 0;
  };
  using Place = std::pair<int32_t, TreeNode>;

  int64_t backOff(double least, double most);
  int64_t holderBackOff(int32_t share);
  bool isOwn(int32_t share) const { return options_.own_share == share; }
  Statement about(int32_t share, const TreeNode& node, bool asks, uint32_t salt);
  void answer(int32_t share, const TreeNode& node, bool asks, int64_t due_us);
  void hearChildren(const Statement& said, uint32_t salt, int64_t now_us);
  void hearLeaves(const Statement& said, int64_t now_us);
  void hearWanted(const Statement& said, int64_t now_us);
  void scheduleRepair(const PieceName& piece, int64_t now_us);
  bool add(RepairTalk& talk, size_t& room, Statement statement) const;
  void addWanted(RepairTalk& talk, size_t& room, int64_t now_us);
  void addAnswers(RepairTalk& talk, size_t& room, int64_t now_us);
  void addQuestions(RepairTalk& talk, size_t& room, int64_t now_us);
  void refill(int64_t now_us);

  AntiEntropyOptions options_;
  Holdings& holdings_;
  Random random_;
  std::map<int32_t, Question> questions_;
  std::map<Place, Answer> answers_;
  std::map<PieceName, Wanted> wanted_;
  std::map<PieceName, int64_t> repairs_;      // when due
  std::map<PieceName, int64_t> said_lately_;  // pieces said again, by whomever, and when
  int64_t tokens_ = 0;                        // bytes of talk allowed now, x 10^6
  int64_t refilled_us_ = 0;
};

}  // namespace shoal::comms
