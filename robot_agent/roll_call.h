// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "fusion_node/mission_state.h"
#include "shoal/world/ids.h"

namespace shoal::robot_agent {

/// Who of a team is still to be waited for, by a robot that has landed: those that fly, and those of which it
/// does not hold all topics. Maps are not waited for: under a thin budget they come much later. A robot that
/// falls silent for long is waited for no more; one that is heard again is.
class RollCall {
 public:
  /// @param self       who waits.
  /// @param team_size  R00 to so many are expected, heard or not; others are when they are heard.
  /// @param wall_s     wall time, any origin: who was never heard is waited for from now on.
  RollCall(world::RobotId self, int32_t team_size, double wall_s);

  /// Looks at what was heard. To be called at least as often as heartbeats come.
  void look(const fusion_node::MissionState& heard, double wall_s);

  /// Names of those that are still to come, ascending. Empty: all are there, or silent.
  std::vector<std::string> missing(double wall_s) const { return unknown(false, wall_s); }

  /// Of those not waited for, who is silent and never was known.
  std::vector<std::string> silent(double wall_s) const { return unknown(true, wall_s); }

 private:
  struct Member {
    double heard_s = 0;  // wall time of its last heartbeat
    double patience_s = 0;
    world::Timestamp said;  // by its own clock
    int32_t epoch = -1;
    bool is_known = false;  // what it has learnt was held
  };
  std::vector<std::string> unknown(bool silent, double wall_s) const;

  world::RobotId self_;
  std::map<world::RobotId, Member> members_;
  std::set<world::RobotId> excluded_;
};

}  // namespace shoal::robot_agent
