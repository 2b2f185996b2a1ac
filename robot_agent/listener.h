// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "fusion_node/mission_state.h"
#include "fusion_node/repair.h"
#include "fusion_node/silence_alarm.h"
#include "robot_agent/voice.h"
#include "shoal/comms/bus.h"
#include "shoal/comms/mission_clock.h"
#include "shoal/wire/heartbeat_codec.h"

namespace shoal::robot_agent {

struct ListenerOptions {
  world::RobotId robot{};
  int32_t mission = 1;
  int64_t budget = 0;  ///< bytes per second of mission time, 0 = unlimited
  bool fuses = false;  ///< holds everybody's beliefs
  /// As of fusion_node::RepairOptions.
  std::function<void(uint64_t key)> make_wanted = {};
};

/// What one robot hears of the others: their state, what they lack and are to be told again, and what is
/// wrong with the mission.
class Listener {
 public:
  /// All outlive it. What is to be asked and said again goes out through `voice`.
  Listener(const ListenerOptions& options, comms::Bus& bus, comms::MissionClock& clock,
           fusion_node::MissionState& state, Voice& voice);

  /// Takes in what has come, or comes within `timeout_ms` of wall time when nothing has.
  void hear(int timeout_ms);

  /// Logs what has come to be wrong: silence, another mission, another process of this name. Each once.
  void warn();

  /// Offers what is due to be asked and said again. As fusion_node::Repair::pump().
  int64_t repair(int64_t now_us) { return repair_.pump(now_us); }

  /// While it is wanted, asks for all that it lacks, as a node that fuses does.
  void wantAll(bool wanted) { repair_.wantAll(wanted); }

  /// True when all nodes that fuse hold all that this robot has said, and there is one. Nodes that said that
  /// they leave, or that were not heard for long, are not waited for, but for what they had held by then. A
  /// robot that fuses too is done when all others that did have said that they leave: nobody is left to be
  /// told.
  bool isHeard();

  /// Fills in what the heartbeat says of this.
  void report(wire::Heartbeat& heartbeat, int64_t now_us);

 private:
  const ListenerOptions options_;
  const std::string name_;
  comms::Bus& bus_;
  comms::MissionClock& clock_;
  fusion_node::MissionState& state_;
  Voice& voice_;
  fusion_node::Repair repair_;
  fusion_node::SilenceAlarm silence_;
  bool warned_of_twin_ = false;
  size_t warned_of_missions_ = 0;
};

}  // namespace shoal::robot_agent
