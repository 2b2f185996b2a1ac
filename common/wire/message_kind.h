// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "shoal/wire/result.h"
#include "shoal/world/ids.h"

namespace shoal::wire {

/// The types that travel. A channel is SHOAL_<NODE>_<KIND>.
enum class MessageKind : uint8_t {
  kHeartbeat,
  kTopics,
  kBrick,
  kCertainty,
  kMatches,
  kLabels,
  kMap,
  kEdit,
  kPicture,
  kRequest,
  kRepair,
  kSettings
};

inline constexpr std::array<std::string_view, 12> kChannelKinds = {
    "HEARTBEAT", "TOPICS", "BRICK",   "CERTAINTY", "MATCHES", "LABELS",
    "MAP",       "EDIT",   "PICTURE", "REQUEST",   "REPAIR",  "SETTINGS"};
inline constexpr size_t kNumMessageKinds = kChannelKinds.size();

/// The last word of the channel a kind travels on, e.g. "TOPICS".
constexpr std::string_view channelKind(MessageKind kind) { return kChannelKinds[static_cast<size_t>(kind)]; }

/// The inverse of channelKind().
std::optional<MessageKind> parseChannelKind(std::string_view text);

/// LCM's fingerprint of the generated type: the first eight bytes of every message.
int64_t fingerprintOf(MessageKind kind);

/// Bytes of a message before its payload, fingerprint included.
size_t fixedBytesOf(MessageKind kind);

/// The inverse of fingerprintOf(); nothing for a type that is not ours.
std::optional<MessageKind> kindOf(int64_t fingerprint);

/// What stands at the front of every message.
struct Header {
  MessageKind kind{};
  world::Timestamp time;  ///< mission time of sending
  int32_t mission = 0;
};

/// Reads the front of a message without decoding the rest: says nothing about whether the rest is good.
Result<Header> peek(std::span<const uint8_t> bytes);

/// How many bytes follow what the message declares as its own length: 0 of a whole message, kSealRoom of one
/// that is sealed. Says nothing about whether the message is good.
Result<size_t> bytesBehind(std::span<const uint8_t> bytes);

/// Writes the time of sending into an encoded message of ours, checksum included. Content is encoded once,
/// with time 0, so that equal content is equal bytes in the send queue; it is stamped when it goes out.
void stampTime(std::span<uint8_t> message, world::Timestamp time);

}  // namespace shoal::wire
