// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ctime>

namespace shoal {

/// Milliseconds of CPU that this thread has taken: what work costs, however busy the machine is.
inline double threadCpuMs() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

}  // namespace shoal
