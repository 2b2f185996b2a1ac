// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "fusion_node/clock_watch.h"
#include "fusion_node/event_log.h"
#include "fusion_node/link_watch.h"
#include "fusion_node/sent_bytes.h"
#include "fusion_node/twin_watch.h"
#include "shoal/comms/packet.h"
#include "shoal/comms/stats.h"
#include "shoal/mapping/belief_store.h"
#include "shoal/mapping/fused_map.h"
#include "shoal/mapping/queries.h"
#include "shoal/wire/heartbeat_codec.h"

namespace shoal::fusion_node {

/// The state and the map of whoever answers.
struct Digests {
  uint64_t state = 0, map = 0;
};

/// A heartbeat as the answer to `status` shows it.
mapping::NodeStatus statusOf(const std::string& node, const wire::Heartbeat& heartbeat, bool heard_whole,
                             const Digests& ours);

/// What one process knows of a mission from all that it has heard: the replicated state, the last heartbeat
/// of every node, and the map they add up to. Used by fusion nodes, by robots that fuse, and to read
/// recordings. Nothing that is heard is trusted: what is bad is counted in Stats under its reason and left
/// out.
class MissionState {
 public:
  /// @param mission  Only messages of this mission enter.
  /// @param limits   What is held at most of what others say; the rest is counted as "over limit".
  /// @throws std::invalid_argument when the matcher options are wrong.
  MissionState(int32_t mission, const matching::MatcherOptions& matcher, double cell_size_m = 1.0,
               const mapping::StoreLimits& limits = {});

  /// Takes a message in. Refusals are counted in `stats`.
  /// @returns true when it holds state that was not held before.
  bool hear(const comms::Packet& packet, comms::Stats& stats);
  /// The same with a message of a memory. It does not count for links: a memory leaves out what was heard
  /// and held nothing new.
  bool recall(const comms::Packet& packet, comms::Stats& stats);

  /// Wall time, seconds, growing: who is silent for long is lost.
  void passTime(double wall_s) { events_.passTime(wall_s); }
  /// What happened to nodes, as it was heard here.
  std::vector<mapping::MissionEvent> events() const { return events_.events(); }

  /// What happened in an earlier life, after all that was heard in it has been heard again.
  void restoreEvents(const std::vector<mapping::MissionEvent>& events) { events_.restore(events); }

  /// Takes in a piece of one's own.
  mapping::Applied apply(const mapping::Piece& piece);

  /// Calls `listener` with every piece that is heard from now on, and whether somebody said it again.
  void onPiece(std::function<void(const mapping::Piece&, bool repaired)> listener) {
    on_piece_ = std::move(listener);
  }

  const mapping::BeliefStore& beliefs() const { return beliefs_; }
  /// The last of every node; its bytes sent are those of all its lives that were heard.
  const std::map<std::string, wire::Heartbeat>& heartbeats() const { return heartbeats_; }
  /// Ids of other missions that were heard.
  const std::set<int32_t>& otherMissions() const { return other_missions_; }
  /// Pieces of equal version and other content: two processes with one robot id.
  int32_t conflicts() const { return conflicts_; }
  /// Seconds that a robot's clock may be off before mixtures() says so. Where robots fly as fast as possible
  /// their clocks run apart, and that is no fault: leave it high there.
  void setClockTolerance(double seconds) { clock_tolerance_s_ = seconds; }
  static constexpr double kClockTolerance = 1200;
  /// What does not belong together: clocks that are off, twins, other missions, other settings.
  std::vector<mapping::Mixture> mixtures() const;
  /// Who speaks with a key, which we do not have: messages by the names of their channels.
  const std::map<std::string, uint64_t>& sealedNodes() const { return sealed_nodes_; }
  /// Latest mission time in any heartbeat.
  world::Timestamp latestTime() const { return latest_; }

  /// True when the state changed after map() was made.
  bool mapIsStale() const { return fused_.stateDigest() != beliefs_.digest(); }
  /// Fuses anew when the state has changed. Cost: as mapping::FusedMap::update().
  const mapping::FusedMap& refresh();
  /// The same, with the map's cells in a row.
  const mapping::GlobalMap& refreshMap();
  /// As of the last refresh. Cost: nothing, where labels, matches, digest or the number of cells will do.
  const mapping::FusedMap& fused() const { return fused_; }
  /// The same with the cells in a row. Cost: O(cells) for the first who asks after a refresh.
  const mapping::GlobalMap& map() const;
  uint64_t mapDigest() const { return fused_.digest(); }

  /// For the heartbeat: how much is held of every robot.
  std::vector<wire::Heartbeat::Share> roster() const;
  /// True when all is held that this robot says it has.
  bool holdsWhole(const std::string& robot) const;
  /// True when this robot has landed and all is held that it has learnt: its topics, its settings.
  bool holdsLearnt(const std::string& robot) const;
  /// LinkWatch::missedOf().
  std::optional<int64_t> missedOf(const std::string& node) const { return links_.missedOf(node); }

  /// Edge of a cell as most robots say, metres; as the heartbeat of the lowest says before that, and the
  /// constructor's before any was heard.
  double cellSize() const;

  /// Everything as one value to ask questions of, with the map as of the last refresh.
  mapping::MissionView view() const;
  /// The same without the map's cells. Cost: O(nodes).
  mapping::MissionView overview() const;

  const matching::MatcherOptions& matcher() const { return matcher_; }

 private:
  bool takeIn(const comms::Packet& packet, comms::Stats& stats, bool is_live);
  bool take(const mapping::Piece& piece, bool repaired, comms::Stats& stats);

  EventLog events_;
  int32_t mission_;
  matching::MatcherOptions matcher_;
  double cell_size_m_;
  mapping::BeliefStore beliefs_;
  std::map<std::string, wire::Heartbeat> heartbeats_;
  std::map<std::string, SentBytes> sent_;  // by the same names
  std::set<int32_t> other_missions_;
  std::map<std::string, uint64_t> sealed_nodes_;
  ClockWatch clocks_;
  TwinWatch twins_;
  LinkWatch links_;
  double clock_tolerance_s_ = kClockTolerance;
  int32_t conflicts_ = 0;
  world::Timestamp latest_;
  mapping::FusedMap fused_;
  mutable mapping::GlobalMap map_;  // of fused_, unless map_is_old_
  mutable bool map_is_old_ = false;
  std::function<void(const mapping::Piece&, bool repaired)> on_piece_;
};

}  // namespace shoal::fusion_node
