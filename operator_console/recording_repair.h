// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "shoal/comms/packet.h"
#include "shoal/wire/heartbeat_codec.h"

namespace shoal::console {

/// What to say on the link so that nodes say again what a recording lacks: the logger only listens. Requests
/// that name all that the recording holds of each share that differs from what its robot last said it has;
/// whoever holds more then says it.
/// @param most_bytes  of one message's payload, >= 100.
/// @returns messages of the node LAUNCH, stamped with time 0.
/// @throws std::runtime_error naming the file when it cannot be read.
std::vector<comms::Packet> requestsForRecording(const std::string& path, int32_t mission,
                                                const std::map<std::string, wire::Heartbeat>& heartbeats,
                                                size_t most_bytes);

}  // namespace shoal::console
