// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "fusion_node/mission_state.h"
#include "robot_agent/checkpoint.h"
#include "shoal/comms/bus.h"
#include "shoal/comms/sender.h"
#include "shoal/mapping/belief_store.h"
#include "shoal/mapping/piece.h"
#include "shoal/wire/bytes.h"
#include "shoal/wire/heartbeat_codec.h"

namespace shoal::robot_agent {

struct VoiceOptions {
  world::RobotId robot{};
  int32_t mission = 1;
  int64_t budget = 0;                         ///< bytes per second of mission time, 0 = unlimited
  std::optional<int64_t> resumed_at_us = {};  ///< comes back, at this time
  /// Of this mission time, with what report() says of the voice.
  std::function<wire::Heartbeat(int64_t now_us)> make_heartbeat = {};
};

/// What one robot says to the others, and what it has said. A piece that is said counts as said at once and
/// waits in the send queue under a key of its own; whoever is next shares its datagram with others of its
/// kind. What is said twice in one version must be the same twice.
class Voice {
 public:
  /// What is said is taken into `state` too. Both outlive it.
  Voice(const VoiceOptions& options, comms::Bus& bus, fusion_node::MissionState& state);
  Voice(const Voice&) = delete;
  Voice& operator=(const Voice&) = delete;

  /// @param message  the part encoded, with time of sending 0.
  void say(const mapping::Piece& part, wire::Bytes message);

  /// Under which a part waits in the send queue.
  static std::string queueKey(const mapping::PieceKey& key, int32_t part);

  /// Does not say any more what waits, if it does.
  void forget(const mapping::PieceKey& key, int32_t part);

  /// True when it was said and has not gone out.
  bool isWaiting(const mapping::Piece& piece) const;

  /// Bytes of the message for a piece of this kind that carry most under the budget; under that of the first
  /// life, for a version that is said again must be cut into the same parts.
  size_t mostBytes(const mapping::Piece& piece) const;

  /// All that was said, in the newest versions.
  const mapping::BeliefStore& said() const { return said_; }

  /// Where repairs and heartbeats go out too.
  comms::Sender& sender() { return sender_; }
  const comms::Sender& sender() const { return sender_; }

  /// Adds what was said.
  void saveTo(Checkpoint& checkpoint) const;
  /// As if that had been said, but for what waited then, which is said again.
  void restore(const Checkpoint& checkpoint);

  /// Fills in what the heartbeat says of this.
  void report(wire::Heartbeat& heartbeat) const;

 private:
  void offer(const mapping::Piece& part, wire::Bytes message);
  std::optional<comms::Packet> join(std::span<const comms::SendQueue::Next> together) const;
  comms::SenderOptions senderOptions();

  const VoiceOptions options_;
  const std::string name_;
  const size_t trailer_;  // bytes of a datagram that the bus adds
  Checkpoint::Cut cut_;
  fusion_node::MissionState& state_;
  mapping::BeliefStore said_;
  std::map<std::string, mapping::Piece, std::less<>> offered_;  // by keys of the send queue
  comms::Sender sender_;
};

}  // namespace shoal::robot_agent
