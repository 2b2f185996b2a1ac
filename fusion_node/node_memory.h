// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "fusion_node/mission_state.h"
#include "shoal/comms/log_writer.h"

namespace shoal::fusion_node {

/// What a node has heard, kept in its state folder as an LCM log of this mission alone: every piece once,
/// heartbeats now and then. A piece is in the file before the node's heartbeat can say that it is held, so a
/// node that is killed at any moment comes back with all that it has acknowledged. What newer versions have
/// voided is left out when the file has grown to a multiple of what is held.
class NodeMemory {
 public:
  /// @param node  The node whose memory it is: its heartbeats are kept too, for its clock.
  NodeMemory(std::string folder, std::string node, int32_t mission);

  /// Takes all that was kept into `state`. Returns the node's mission time in its last heartbeat, and the
  /// wall time of that, microseconds since 1970; nothing when there is none.
  /// @throws std::runtime_error naming the file that cannot be read.
  std::optional<std::pair<int64_t, int64_t>> recall(MissionState& state);

  /// A packet was heard, or said by this node itself; `is_new` as MissionState::hear() says.
  /// @throws std::runtime_error naming the file that cannot be written.
  void keep(const comms::Packet& packet, bool is_new, const MissionState& state);

 private:
  void rewrite(const MissionState& state);

  std::string path_;
  std::string node_;
  int32_t mission_;
  std::optional<comms::LogWriter> log_;
  uint64_t rewrite_at_bytes_;
  std::map<std::string, int64_t> heartbeat_kept_us_;  // by channel: mission time
};

}  // namespace shoal::fusion_node
