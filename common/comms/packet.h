// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace shoal::comms {

using Bytes = std::vector<uint8_t>;

/// What a packet is for; the order is the order of utility per byte. Every class drains.
/// After the local bus: the talk about what lacks, and what is said again because somebody lacked it.
enum class TrafficClass : uint8_t {
  kHeartbeat,
  kMatches,
  kTopics,
  kBricks,
  kCertainty,
  kPictures,
  kLocal,
  kRequests,
  kRepairs
};
inline constexpr size_t kNumTrafficClasses = 9;
inline constexpr std::array<std::string_view, kNumTrafficClasses> kTrafficClassNames = {
    "heartbeat", "matches", "topics", "bricks", "certainty", "pictures", "local", "requests", "repairs"};

/// A message, opaque here: channel and encoded bytes.
struct Packet {
  std::string channel;
  Bytes bytes;
  size_t trailer = 0;  ///< Bytes that stand behind it on the wire: what a bus adds when it publishes.
};

/// A datagram's cost on the wire: payload, channel with its NUL, LCM's 8-byte header, UDP 8, IP 20.
constexpr size_t wireSize(size_t channel_length, size_t payload) {
  return payload + channel_length + 1 + 8 + 28;
}
inline size_t wireSize(const Packet& packet) {
  return wireSize(packet.channel.size(), packet.bytes.size() + packet.trailer);
}

/// No message is larger: LCM header, channel, NUL and payload together (DESIGN: every message <= 1400 bytes).
inline constexpr size_t kMaxMessageBytes = 1400;
constexpr size_t messageSize(size_t channel_length, size_t payload) {
  return 8 + channel_length + 1 + payload;
}
inline size_t messageSize(const Packet& packet) {
  return messageSize(packet.channel.size(), packet.bytes.size() + packet.trailer);
}

/// The largest datagram on the wire.
inline constexpr size_t kMaxWireBytes = kMaxMessageBytes + 28;

}  // namespace shoal::comms
