// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "shoal/wire/heartbeat_codec.h"

namespace shoal::console {

/// What a recording lacks to rebuild a mission's state by itself: one line for each robot whose share of the
/// state, as its heartbeat tells it, the recording does not add up to. Empty when it holds everything and
/// adds up to `state_digest`.
/// @throws std::runtime_error naming the file when it cannot be read.
std::vector<std::string> lackingInLog(const std::string& path, int32_t mission, uint64_t state_digest,
                                      const std::map<std::string, wire::Heartbeat>& heartbeats);

}  // namespace shoal::console
