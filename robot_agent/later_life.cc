// SPDX-License-Identifier: BSD-3-Clause
#include "robot_agent/later_life.h"

namespace shoal::robot_agent {

bool LaterLife::follows(int32_t last, world::Observation& observation) {
  if (!live_) return observation.number > last;
  if (observation.number > last) {
    observation.number += skipped_;
  } else {
    skipped_ = last + 1 - observation.number;
    observation.number = last + 1;
  }
  if (skipped_ > 0) observation.time.us += begins_at_us_;
  return true;
}

}  // namespace shoal::robot_agent
