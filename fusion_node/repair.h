// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "fusion_node/mission_state.h"
#include "shoal/comms/anti_entropy.h"
#include "shoal/comms/sender.h"

namespace shoal::fusion_node {

/// A piece's name and version, as anti-entropy sees them. Its share is its robot's number.
comms::AntiEntropy::PieceName nameOf(const mapping::PieceKey& key, int32_t part);
uint64_t versionOf(const world::Version& version);

/// A MissionState as holdings: trees are made when they are asked for and kept while the share's digest is
/// the same. What others are known to hold is what their heartbeats say.
class StateHoldings final : public comms::Holdings {
 public:
  /// @param patient  A node that needs nothing for itself: it doubts only what no fusing node that it hears
  ///                 has, so that it can pass it on. `state` outlives it.
  StateHoldings(const MissionState& state, std::string node, bool patient)
      : state_(state), node_(std::move(node)), patient_(patient) {}

  void setPatient(bool patient) { patient_ = patient; }

  /// Of the share of this node what is still to be said for the first time is not held yet: nobody lacks it.
  /// @param queue  in which it waits; outlives this.
  void leaveOut(std::function<bool(const mapping::Piece&)> is_unsaid, const comms::SendQueue& queue) {
    is_unsaid_ = std::move(is_unsaid);
    queue_ = &queue;
  }

  const comms::DigestTree& treeOf(int32_t share) override;
  bool isDoubted(int32_t share) override;
  std::optional<int64_t> missed(int32_t share) override;

  /// The piece of that name; null when it is not held.
  const mapping::Piece* find(const comms::AntiEntropy::PieceName& piece);

  /// A heartbeat was heard; returns the shares of which its sender holds something else.
  std::vector<int32_t> heardFrom(const std::string& node, int64_t now_us);

  /// True when a node other than this one was heard within the time that its heartbeats may take.
  bool hears(const std::string& node, int64_t now_us);

  /// What is held of other robots and what no fusing node that is heard has had for a while: somebody may
  /// carry it further.
  std::vector<wire::Heartbeat::Share> unmet(int64_t now_us);

 private:
  struct Tree {
    uint64_t digest = 0;
    comms::DigestTree tree;
    std::map<uint64_t, std::pair<mapping::PieceKey, int32_t>> pieces;  // by key
  };
  struct Said {
    uint64_t digest = 0;
    uint64_t revision = 0;  // of the queue
    comms::DigestTree tree;
  };
  const Tree& made(int32_t share);
  const comms::DigestTree& madeOfSaid(int32_t share);  // of this node's own
  const wire::Heartbeat* lately(const std::string& node) const;
  bool isHeldByFusingNode(world::RobotId robot, uint32_t digest) const;

  const MissionState& state_;
  std::string node_;
  bool patient_;
  std::function<bool(const mapping::Piece&)> is_unsaid_;
  const comms::SendQueue* queue_ = nullptr;
  int64_t now_us_ = 0;
  std::map<std::string, int64_t> heard_us_;  // nodes, by our clock
  std::map<world::RobotId, int64_t> unmet_since_us_;
  std::map<int32_t, Tree> trees_;
  Said said_;
};

struct RepairOptions {
  std::string node;  ///< this one
  int32_t mission = 1;
  int64_t budget = 0;                     ///< bytes per second, 0 = unlimited
  std::optional<int32_t> own_share = {};  ///< of a robot: its number
  bool fuses = true;                      ///< else it only passes on what others lack
  /// True for a piece of its own that is still to be said for the first time. None when empty.
  std::function<bool(const mapping::Piece&)> is_unsaid = {};
  /// Somebody wants a piece of its own share that it does not hold, by its key as in nameOf(): it may make
  /// it. None when empty.
  std::function<void(uint64_t key)> make_wanted = {};
};

/// A node's part in repairing the state: hears requests and heartbeats, and gives the sender what to ask and
/// what to say again. Requests are at most an eighth of the budget; repairs come after everything new.
class Repair {
 public:
  /// Both outlive it. Registers itself with `state`, which must not move.
  Repair(const RepairOptions& options, MissionState& state, comms::Sender& sender);
  Repair(const Repair&) = delete;
  Repair& operator=(const Repair&) = delete;

  /// To be called with every packet, after MissionState::hear(). Refusals are counted in the sender's stats.
  void hear(const comms::Packet& packet, int64_t now_us);

  /// Offers what is due. To be called before Sender::pump(); returns when there may be more, > now_us.
  int64_t pump(int64_t now_us);

  /// While it is wanted a node that does not fuse asks for all that it lacks, as one that does.
  void wantAll(bool wanted) { holdings_.setPatient(!options_.fuses && !wanted); }

  /// Asks for a piece, in this version or a newer one, until it is heard or a few askings have been in vain.
  void ask(const mapping::PieceKey& key, int32_t part, const world::Version& version);

  /// True when `node` was heard lately: for a minute it may be silent, for longer under a thin budget.
  bool hears(const std::string& node, int64_t now_us) { return holdings_.hears(node, now_us); }

  /// For a heartbeat: what a node that fuses holds of every robot; of others StateHoldings::unmet().
  std::vector<wire::Heartbeat::Share> roster(int64_t now_us);

 private:
  void makeWanted(const comms::RepairTalk& talk);
  bool isFlood(const std::string& node, int64_t now_us);

  RepairOptions options_;
  MissionState& state_;
  comms::Sender& sender_;
  StateHoldings holdings_;
  comms::AntiEntropy talk_;
  int64_t now_us_ = 0;
  std::map<std::string, std::pair<int64_t, int>> asks_;  // by node: this second of ours, and how many in it
};

}  // namespace shoal::fusion_node
