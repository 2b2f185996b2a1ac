// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "fusion_node/mission_state.h"
#include "shoal/comms/packet.h"
#include "shoal/comms/stats.h"
#include "shoal/comms/window_meter.h"
#include "shoal/mapping/queries.h"
#include "shoal/wire/heartbeat_codec.h"

namespace shoal::console {

/// What `launch` knows of a mission by listening: who is how far, who holds what, and who sent how much.
/// Nothing it hears is trusted: what cannot be read is passed over.
class MissionWatch {
 public:
  /// Robots R00 ... and the node OPERATOR are expected.
  MissionWatch(int32_t mission, int num_robots, int64_t budget);

  void hear(const comms::Packet& packet);

  /// The last heartbeat of each node of this mission.
  const std::map<std::string, wire::Heartbeat>& nodes() const { return state_.heartbeats(); }

  /// The same for people, robots first; `heard_whole` is what OPERATOR says.
  std::vector<mapping::NodeStatus> statuses() const;

  /// Robots that have not been heard yet, and OPERATOR when it has not.
  std::vector<std::string> unheard() const;

  /// @param other_than  this robot, which is not asked.
  bool allLanded(const std::string& other_than = {}) const;

  /// What still lacks before the mission is over: every robot has landed, and each node that fuses (OPERATOR
  /// does) holds all that every robot has, has fused that, and has the same map as the others. One line an
  /// item; empty when it is over.
  std::vector<std::string> lacking() const;

  /// Differs when anything got on: images, states, maps.
  uint64_t progress() const;

  /// The state that OPERATOR says it holds, and its map's digest; 0 before it was heard.
  uint64_t stateDigest() const;
  uint64_t mapDigest() const;

  /// Latest mission time in any heartbeat, seconds.
  double missionTime() const;

  /// Mission time at which this node was last heard to send anything, seconds; 0 before it was heard.
  double lastSentAt(const std::string& node) const;

  /// A mission other than ours that was heard.
  std::optional<int32_t> otherMission() const;

  /// The window of mission time in which a node came closest to its budget (or went over it), over the nodes.
  struct WorstWindow {
    std::string node;  ///< empty before anything was heard
    comms::MeteredWindow window;
  };
  WorstWindow worstWindow() const;

 private:
  const wire::Heartbeat* find(const std::string& node) const;
  bool holdsWhole(const wire::Heartbeat& fusing, const std::string& robot) const;
  void addLacking(const std::string& node, const wire::Heartbeat& fusing,
                  std::vector<std::string>& lacking) const;

  int32_t mission_;
  int64_t budget_;
  std::vector<std::string> robots_;
  fusion_node::MissionState state_;  // hears heartbeats alone
  comms::Stats refused_;
  std::map<std::string, comms::WindowMeter> sent_;
  std::map<std::string, int64_t> last_sent_us_;
};

}  // namespace shoal::console
