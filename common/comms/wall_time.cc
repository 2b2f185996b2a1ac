// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/wall_time.h"

#include <chrono>
#include <thread>

namespace shoal::comms {

WallTime realWallTime() {
  using std::chrono::microseconds;
  return {.now_us =
              [] {
                const auto since_origin = std::chrono::steady_clock::now().time_since_epoch();
                return static_cast<int64_t>(std::chrono::duration_cast<microseconds>(since_origin).count());
              },
          .sleep_us = [](int64_t us) { std::this_thread::sleep_for(microseconds(us)); }};
}

}  // namespace shoal::comms
