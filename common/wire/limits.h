// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "shoal/world/ids.h"
#include "shoal/world/mission_time.h"

namespace shoal::wire {

/// The longest encoded message that can stand in a datagram of 1400 bytes: LCM's header takes 8, the channel
/// at least its NUL. Senders subtract the length of their channel too: see maxPayload().
inline constexpr size_t kMaxMessageBytes = 1400 - 8 - 1;

/// Left free at the end of every datagram for the seal of a team with a key (comms/seal.h), with a key or
/// not: so that what is said, and how it is cut, does not depend on it.
inline constexpr size_t kSealRoom = 16;

/// What may be sent on a channel of that many letters, so that LCM header, channel, NUL, message and seal
/// together stay within 1400 bytes. @p channel_length at most 63, LCM's own limit.
constexpr size_t maxPayload(size_t channel_length) { return kMaxMessageBytes - kSealRoom - channel_length; }

// Caps on what one message may make a receiver hold. No honest sender reaches them.
inline constexpr int32_t kMaxRobotNumber = 9999;
inline constexpr int32_t kMaxShareNumber = 10000;  // robots, and what operators decided: mapping::kOperators
inline constexpr int32_t kMaxParts = 255;
inline constexpr int32_t kMaxBrickCells = 16 * 16 * 16;
inline constexpr size_t kMaxBricksPerMessage = 1024;
inline constexpr size_t kMaxCellsPerMessage = 32768;
inline constexpr size_t kMaxPlacesPerMessage =
    131072;  // asked about, is there a cell? Decoding takes so long
inline constexpr int32_t kMaxPictureLayers = 4;
inline constexpr size_t kMaxLayerBytes = 540;
inline constexpr size_t kMaxTopicsPerMessage = 256;
inline constexpr size_t kMaxWordsPerMessage = 65536;
inline constexpr int32_t kMaxWordGroups = 64;
inline constexpr int32_t kMaxVocabulary = 1 << 20;
inline constexpr int32_t kMaxRoster = 256;
inline constexpr int32_t kMaxCorrespondencesPerChunk = 16384;
inline constexpr int32_t kMaxLabelsPerChunk = 4096;
inline constexpr int32_t kMaxRobotsPerLabel = 256;
inline constexpr int32_t kMaxLabel = kMaxRobotNumber * 10000 + world::kMaxTopicId;
inline constexpr size_t kMaxNameBytes = 64;
inline constexpr int32_t kMaxChunks = 32767;

using world::kMaxTimeUs;
constexpr bool isTime(world::Timestamp time) { return time.us >= 0 && time.us <= kMaxTimeUs; }

}  // namespace shoal::wire
