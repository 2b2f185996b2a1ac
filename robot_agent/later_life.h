// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "shoal/world/observation.h"

namespace shoal::robot_agent {

/// What a source shows to a robot that may have lived before. A world or a recording begins anew: what was
/// learnt from is left out. A live source has gone on: its numbers and its times are made to follow.
class LaterLife {
 public:
  /// @param live      what the source has shown it will not show again.
  /// @param start_us  mission time at which this life began; 0 in the first.
  LaterLife(bool live, int64_t start_us) : live_(live), start_us_(start_us) {}

  /// Makes `observation` the one that follows number `last`, which is -1 before the first.
  /// @returns false when it was learnt from in an earlier life.
  bool follows(int32_t last, world::Observation& observation);

 private:
  const bool live_;
  const int64_t start_us_;
  int32_t skipped_ = 0;  // numbers, in earlier lives
};

}  // namespace shoal::robot_agent
