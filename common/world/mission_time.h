// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace shoal::world {

/// Mission times lie in [0, kMaxTimeUs]: sums and differences of two cannot overflow.
inline constexpr int64_t kMaxTimeUs = (int64_t{1} << 62) - 1;

}  // namespace shoal::world
