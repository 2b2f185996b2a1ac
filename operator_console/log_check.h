// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "shoal/mapping/belief_store.h"
#include "shoal/wire/heartbeat_codec.h"

namespace shoal::console {

/// What a recording lacks of what robots said they had, in the last heartbeat of each: PieceAudit::lacking()
/// of each robot whose share has another digest. Empty when nothing lacks.
/// @param beliefs  what the recording adds up to.
/// @throws std::runtime_error naming the file when it cannot be read.
std::vector<std::string> lackingPieces(const std::string& path, int32_t mission,
                                       const mapping::BeliefStore& beliefs,
                                       const std::map<std::string, wire::Heartbeat>& heartbeats,
                                       const std::string& key_file = {});

/// What a recording lacks to rebuild a mission's state by itself: lackingPieces(), or else a line when it
/// does not add up to `state_digest`. Empty when it holds everything.
/// @throws std::runtime_error naming the file when it cannot be read.
std::vector<std::string> lackingInLog(const std::string& path, int32_t mission, uint64_t state_digest,
                                      const std::map<std::string, wire::Heartbeat>& heartbeats,
                                      const std::string& key_file = {});

}  // namespace shoal::console
