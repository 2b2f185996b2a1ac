// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace shoal::comms {

inline constexpr int64_t kSecond = 1'000'000;  // microseconds

}  // namespace shoal::comms
