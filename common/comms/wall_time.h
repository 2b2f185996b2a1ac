// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>

namespace shoal::comms {

/// The wall clock as a value, so that tests run without sleeping. Both functions must be set.
struct WallTime {
  std::function<int64_t()> now_us;        ///< Monotonic, arbitrary origin.
  std::function<void(int64_t)> sleep_us;  ///< May return early or late.
};

/// The machine's monotonic clock.
WallTime realWallTime();

}  // namespace shoal::comms
