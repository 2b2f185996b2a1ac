// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "fusion_node/mission_state.h"
#include "shoal/matching/matcher.h"
#include "shoal/world/ids.h"

namespace shoal::console {

/// What one node of a mission held at a time, as a recording and the node's own heartbeats tell it: a robot
/// its own beliefs; who fuses also of every other robot what its roster says.
struct Holding {
  struct Share {
    world::RobotId robot{};  ///< or mapping::kOperators, mapping::kLibrary
    bool is_whole = false;   ///< all that the robot had to say by its own last heartbeat
    bool is_certain = true;  ///< else it is what the node surely held, and it may have held more
    double until_s = 0;      ///< mission time of the last message of it that it held
  };
  std::string node;
  double at_s = 0;     ///< mission time of the heartbeat that is gone by
  bool fuses = false;  ///< else it holds no more than its own
  /// The map adds up to the very digest that the node said; nothing when it said none of just that state.
  std::optional<bool> agrees;
  std::vector<Share> shares;  ///< ascending
  fusion_node::MissionState state;

  /// {"node", "at_s", "fuses", "agrees", "shares": [{"robot", "whole", "certain", "until_s"}]}
  nlohmann::ordered_json json() const;
};

/// Reads the recording twice: once to know after which message every robot's share had which digest, once to
/// take in what the roster names.
/// @param until  messages of a later mission time are left out; none: all count.
/// @throws std::runtime_error as readRecording(), and when no heartbeat of the node was recorded by then.
Holding holdingOf(const std::string& recording, const std::string& key_file,
                  const matching::MatcherOptions& matcher, const std::string& node,
                  std::optional<world::Timestamp> until = {});

}  // namespace shoal::console
