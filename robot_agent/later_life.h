// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "shoal/world/observation.h"

namespace shoal::robot_agent {

/// What a source shows to a robot that may have lived before. A world or a recording begins anew: what was
/// learnt from is left out. A live source has gone on: its numbers are made to follow, and its times when
/// they begin anew with every life.
class LaterLife {
 public:
  /// @param live      what the source has shown it will not show again.
  /// @param begins_at_us  mission time of what a live source calls 0 in a later life; 0 when it goes by
  ///                      mission time itself.
  LaterLife(bool live, int64_t begins_at_us) : live_(live), begins_at_us_(begins_at_us) {}

  /// Makes `observation` the one that follows number `last`, which is -1 before the first.
  /// @returns false when it was learnt from in an earlier life.
  bool follows(int32_t last, world::Observation& observation);

 private:
  const bool live_;
  const int64_t begins_at_us_;
  int32_t skipped_ = 0;  // numbers, in earlier lives
};

}  // namespace shoal::robot_agent
