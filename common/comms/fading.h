// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "shoal/comms/link_model.h"

namespace shoal::comms {

/// Whether the channel that `key` names is bad at mission time at_us >= 0: a pure function, so that it does
/// not matter what else is asked, or when. Time is cut into blocks of 32 (good_s + bad_s); each begins in
/// one of the two states, with the probability that it has at any time, and goes on from there on its own.
/// Cost: O(64) random numbers in the mean.
bool isBad(const Bursts& bursts, uint64_t key, int64_t at_us);

}  // namespace shoal::comms
