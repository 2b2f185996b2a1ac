// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "shoal/comms/wall_time.h"

namespace shoal::comms {

/// Maps mission time, in microseconds, to wall time. No result depends on it: it only says when to wait.
class MissionClock {
 public:
  /// @param rate      Seconds of mission time per second of wall time; 0 = as fast as possible, never waits.
  /// @param start_us  Mission time at the construction.
  /// @throws std::invalid_argument unless rate is 0 or lies in [0.001, 1000].
  explicit MissionClock(double rate, int64_t start_us = 0, WallTime wall = realWallTime());

  /// Mission time; never runs backwards. At rate 0 the latest time waited for or advanced to, else
  /// never before that.
  int64_t now();

  /// Wall time left until now() reaches mission_us, for waiting in poll(): microseconds, 0 when reached and
  /// at rate 0.
  int64_t wallUntil(int64_t mission_us);

  /// Returns with now() >= mission_us.
  void waitUntil(int64_t mission_us);

  /// Makes now() at least mission_us, without waiting; from there it goes on at its rate.
  void advanceTo(int64_t mission_us);

 private:
  double rate_;
  WallTime wall_;
  int64_t latest_us_;
  int64_t start_us_;
  int64_t wall_start_us_;
};

}  // namespace shoal::comms
