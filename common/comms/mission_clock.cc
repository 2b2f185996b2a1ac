// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/mission_clock.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace shoal::comms {

MissionClock::MissionClock(double rate, int64_t start_us, WallTime wall)
    : rate_(rate), wall_(std::move(wall)), latest_us_(start_us), start_us_(start_us) {
  if (rate != 0 && !(rate >= 0.001 && rate <= 1000)) {
    std::ostringstream what;
    what << "a clock's rate must be 0 (as fast as possible) or lie in [0.001, 1000], got " << rate;
    throw std::invalid_argument(what.str());
  }
  wall_start_us_ = wall_.now_us();
}

int64_t MissionClock::now() {
  if (rate_ != 0) {
    const double elapsed = static_cast<double>(wall_.now_us() - wall_start_us_) * rate_;
    latest_us_ = std::max(latest_us_, start_us_ + static_cast<int64_t>(elapsed));
  }
  return latest_us_;
}

int64_t MissionClock::wallUntil(int64_t mission_us) {
  if (rate_ == 0) return 0;
  const int64_t left_us = mission_us - now();
  if (left_us <= 0) return 0;
  return std::max<int64_t>(1, static_cast<int64_t>(std::ceil(static_cast<double>(left_us) / rate_)));
}

void MissionClock::waitUntil(int64_t mission_us) {
  while (const int64_t left_us = wallUntil(mission_us)) wall_.sleep_us(left_us);
  latest_us_ = std::max(latest_us_, mission_us);  // late or early by what a sleep is
}

void MissionClock::advanceTo(int64_t mission_us) {
  const int64_t ahead_us = mission_us - now();
  if (ahead_us <= 0) return;
  latest_us_ = mission_us;
  start_us_ += ahead_us;
}

}  // namespace shoal::comms
