// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>

#include "robot_agent/checkpoint_saver.h"
#include "robot_agent/listener.h"
#include "robot_agent/voice.h"
#include "shoal/comms/mission_clock.h"
#include "shoal/world/source.h"

namespace shoal::robot_agent {

/// Lets mission time pass for one robot: meanwhile what is due goes out, what has come is heard, and what is
/// saved is said. All of it ends early when a stop is requested, but for awaitSaved().
class Timekeeper {
 public:
  /// All outlive it. @param rate  of the clock, 0 = as fast as possible.
  /// @param heard  called after every time that it has listened.
  Timekeeper(double rate, comms::MissionClock& clock, CheckpointSaver& saver, Voice& voice,
             Listener& listener, std::function<void()> heard);

  /// Until mission time `to_us`; as fast as possible no wall time passes.
  void passTimeUntil(int64_t to_us);

  /// One second of mission time. As fast as possible it still takes a while, so that others get to listen.
  void passSecond();

  /// Until the source is ready, or at its end. Mission time as fast as possible does not pass: only
  /// observations move it.
  void awaitObservation(world::ObservationSource& source);

  /// Until no checkpoint is being written any more.
  void awaitSaved();

  /// While something takes long: sends what is due and hears what has come, which changes nothing of that.
  void breathe();

  /// True while there is something that was not said.
  bool isBusy() const { return voice_.sender().queue().waitingBytes() > 0 || saver_.isHolding(); }

 private:
  int64_t send(int64_t now_us);
  void listen(int timeout_ms);

  const double rate_;
  comms::MissionClock& clock_;
  CheckpointSaver& saver_;
  Voice& voice_;
  Listener& listener_;
  const std::function<void()> heard_;
  std::chrono::steady_clock::time_point breathed_;  // mission time as fast as possible has moved for it
};

}  // namespace shoal::robot_agent
