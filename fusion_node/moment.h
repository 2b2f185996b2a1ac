// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace shoal::fusion_node {

/// A moment by two clocks: the wall clock, which somebody may set, and the time since the machine was
/// started, with the time that it slept, which nobody may; the latter means something within one boot alone.
struct Moment {
  int64_t wall_us = 0;  ///< since 1970
  int64_t boot_us = 0;  ///< since the machine was started
  std::string boot_id;  ///< which start that was; empty = not known
};

Moment thisMoment();

/// What has passed between two moments, microseconds, >= 0.
struct Gap {
  int64_t us = 0;     ///< 0 when it is doubtful
  std::string doubt;  ///< why it is not to be believed; empty when it is
};

/// Of one boot by the time since that, else by the wall clock, which is not believed when it has gone
/// backwards or by more than 30 days.
Gap passedBetween(const Moment& then, const Moment& now);

}  // namespace shoal::fusion_node
