// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "fusion_node/mission_file.h"
#include "fusion_node/mission_state.h"
#include "fusion_node/moment.h"
#include "shoal/wire/heartbeat_codec.h"

namespace shoal::fusion_node {

/// The file in a node's state folder that holds what it heard of a mission.
std::string missionFilePath(const std::string& state_dir, int32_t mission);

/// What a node has heard, kept in its state folder as a MissionFile: every message with a piece that was new,
/// heartbeats now and then, when a robot lands or leaves and the last of a process, and what happened. What
/// was heard at once is one transaction, which is over before the node's heartbeat can say that it is held,
/// so a node that is killed at any moment comes back with all that it has acknowledged. Nothing is thrown
/// away: the file is the mission's history, a few bytes more than what was heard for the first time.
class NodeMemory {
 public:
  /// @param node  The node whose memory it is.
  /// @throws std::runtime_error as MissionFile.
  NodeMemory(const std::string& folder, const std::string& node, int32_t mission);

  struct Clock {
    int64_t mission_us;       ///< mission time
    int64_t spoken_until_us;  ///< at most so late, by mission time, the node has said something
    Moment at;                ///< when that mission time was
  };

  /// Takes all that was kept into `state`. Returns what was told last to keepClock(); nothing when nothing
  /// was, or when somebody wrote a time there that cannot be.
  /// @throws std::runtime_error naming the file that cannot be read.
  std::optional<Clock> recall(MissionState& state);

  /// To be called before the node says anything at that mission time: who comes back knows until when it may
  /// have spoken. Written for two seconds at once, and safe when it returns. What others say in the node's
  /// name plays no part in it. @throws std::runtime_error naming the file that cannot be written.
  void keepClock(int64_t mission_us);

  /// A packet was heard, or said by this node itself; `is_new` as MissionState::hear() says.
  /// @throws std::runtime_error naming the file that cannot be written.
  void keep(const comms::Packet& packet, bool is_new);

  /// The node ends: the last heartbeat of everybody is kept, however soon it came after another.
  /// @throws std::runtime_error naming the file that cannot be written.
  void keepLast();

  /// What was kept is safe; events that are new to it too. To be called after what was heard at once, and
  /// before any of it is acknowledged.
  /// @throws std::runtime_error naming the file that cannot be written.
  void commit(const MissionState& state);

 private:
  struct Kept {
    int64_t time_us;  // of the mission
    wire::Phase phase;
    std::pair<int32_t, int32_t> process;         // host, pid
    std::optional<comms::Packet> left_out = {};  // the newest since
    int64_t left_out_us = 0;                     // when it was said
  };

  void append(const comms::Packet& packet);

  std::string path_;
  int32_t mission_;
  MissionFile file_;
  bool has_kept_ = false;                            // since the last commit
  std::optional<int64_t> clock_us_;                  // as it was written last
  std::map<std::string, Kept> heartbeat_kept_;       // by channel: the last one
  std::optional<mapping::MissionEvent> last_event_;  // that is in the file
};

}  // namespace shoal::fusion_node
