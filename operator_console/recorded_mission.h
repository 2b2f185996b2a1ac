// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "fusion_node/mission_state.h"
#include "operator_console/message_log.h"
#include "shoal/comms/channels.h"
#include "shoal/comms/packet.h"
#include "shoal/matching/matcher.h"
#include "shoal/wire/message_kind.h"

namespace shoal::console {

/// A mission as a recording alone tells it.
struct RecordedMission {
  int32_t mission = 0;
  fusion_node::MissionState state;  ///< of all its messages, fused
  int64_t messages = 0;             ///< of the mission, understood
  int64_t refused = 0;              ///< messages on our channels, and stretches of the file, that were not
  SealCounts seals = {};
};

/// Is shown every message of the mission that was understood, in the order of the recording, after it has
/// entered the state.
using OnMessage = std::function<void(const comms::ChannelName& channel, const wire::Header& header,
                                     const comms::Packet& packet, const fusion_node::MissionState& state)>;

/// Reads a recording from its beginning to its end and fuses what it adds up to. The first heartbeat says
/// which mission it is of. A recording is untrusted input: damage is skipped and counted.
/// @param key_file  as MessageLog().
/// @param until  messages of a later mission time are left out; none: all count.
/// @throws std::runtime_error when the file cannot be read or holds no heartbeat of any mission.
RecordedMission readRecording(const std::string& path, const matching::MatcherOptions& matcher,
                              const OnMessage& on_message = {}, std::optional<world::Timestamp> until = {},
                              const std::string& key_file = {});

}  // namespace shoal::console
