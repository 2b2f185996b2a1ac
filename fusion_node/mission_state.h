// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "fusion_node/event_log.h"
#include "shoal/comms/packet.h"
#include "shoal/comms/stats.h"
#include "shoal/mapping/belief_store.h"
#include "shoal/mapping/fusion.h"
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
  /// @throws std::invalid_argument when the matcher options are wrong.
  MissionState(int32_t mission, const matching::MatcherOptions& matcher, double cell_size_m = 1.0);

  /// Takes a message in. Refusals are counted in `stats`.
  void hear(const comms::Packet& packet, comms::Stats& stats);

  /// Wall time, seconds, growing: who is silent for long is lost.
  void passTime(double wall_s) { events_.passTime(wall_s); }
  /// What happened to nodes, as it was heard here.
  std::vector<mapping::MissionEvent> events() const { return events_.events(); }

  /// Takes in a piece of one's own.
  mapping::Applied apply(const mapping::Piece& piece);

  const mapping::BeliefStore& beliefs() const { return beliefs_; }
  const std::map<std::string, wire::Heartbeat>& heartbeats() const { return heartbeats_; }
  /// Ids of other missions that were heard.
  const std::set<int32_t>& otherMissions() const { return other_missions_; }
  /// Pieces of equal version and other content: two processes with one robot id.
  int32_t conflicts() const { return conflicts_; }
  /// Latest mission time in any heartbeat.
  world::Timestamp latestTime() const { return latest_; }

  /// True when the state changed after map() was made.
  bool mapIsStale() const { return map_.state_digest != beliefs_.digest(); }
  /// Fuses anew when the state has changed. Cost: as mapping::fuse().
  const mapping::GlobalMap& refreshMap();
  const mapping::GlobalMap& map() const { return map_; }
  uint64_t mapDigest() const { return map_digest_; }

  /// For the heartbeat: how much is held of every robot.
  std::vector<wire::Heartbeat::Share> roster() const;
  /// True when all is held that this robot says it has.
  bool holdsWhole(const std::string& robot) const;

  /// Edge of a cell as the lowest robot says, metres; the constructor's before any was heard.
  double cellSize() const;

  /// Everything as one value to ask questions of, with the map as of the last refreshMap().
  mapping::MissionView view() const;

  const matching::MatcherOptions& matcher() const { return matcher_; }

 private:
  void take(const comms::Packet& packet, comms::Stats& stats);

  EventLog events_;
  int32_t mission_;
  matching::MatcherOptions matcher_;
  double cell_size_m_;
  mapping::BeliefStore beliefs_;
  std::map<std::string, wire::Heartbeat> heartbeats_;
  std::set<int32_t> other_missions_;
  int32_t conflicts_ = 0;
  world::Timestamp latest_;
  mapping::GlobalMap map_;
  uint64_t map_digest_ = 0;
};

}  // namespace shoal::fusion_node
