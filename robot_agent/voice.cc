// SPDX-License-Identifier: BSD-3-Clause
#include "robot_agent/voice.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "shoal/comms/budget.h"
#include "shoal/comms/channels.h"
#include "shoal/wire/limits.h"
#include "shoal/wire/message_kind.h"
#include "shoal/wire/piece_codec.h"
#include "shoal/wire/repair_codec.h"

namespace shoal::robot_agent {
namespace {

// Bytes of a piece's datagram that are no content: headers, channel, fixed fields.
constexpr size_t kPieceOverheadBytes = 110;
constexpr size_t kSmallDatagramBytes = 400;

comms::TrafficClass trafficOf(mapping::PieceKind kind) {
  switch (kind) {
    case mapping::PieceKind::kSettings:
    case mapping::PieceKind::kTopic:
      return comms::TrafficClass::kTopics;
    case mapping::PieceKind::kBrick:
      return comms::TrafficClass::kBricks;
    case mapping::PieceKind::kPicture:
      return comms::TrafficClass::kPictures;
    case mapping::PieceKind::kEdit:
      return comms::TrafficClass::kMatches;
    case mapping::PieceKind::kCertainty:
      break;
  }
  return comms::TrafficClass::kCertainty;
}

std::string channelOf(const std::string& robot, wire::MessageKind kind) {
  return comms::channelName(robot, wire::channelKind(kind));
}

// Bytes of a message on a channel that carry most under a thin budget: comms/budget.h. Under the thinnest a
// full datagram would wait for half a minute: then the sooner is worth more than a tenth of the bytes, see
// docs/benchmarks.md.
size_t mostBytesOn(const std::string& channel, int64_t budget, size_t trailer) {
  size_t best = comms::efficientDatagram(budget, kPieceOverheadBytes);
  if (budget > 0) best = std::min(best, std::max(kSmallDatagramBytes, static_cast<size_t>(8 * budget)));
  const size_t most = std::min(wire::maxPayload(channel.size()), wire::kMaxRepairableBytes);
  return std::min(most, best - comms::wireSize(channel.size(), trailer));
}

}  // namespace

Voice::Voice(const VoiceOptions& options, comms::Bus& bus, fusion_node::MissionState& state)
    : options_(options),
      name_(name(options.robot)),
      trailer_(bus.trailerBytes()),
      cut_{options.budget, static_cast<int64_t>(trailer_)},
      state_(state),
      sender_(bus, nullptr, senderOptions()) {
  bus.countInto(sender_.stats());
  if (options_.resumed_at_us) sender_.assumeExhausted(*options_.resumed_at_us);
}

comms::SenderOptions Voice::senderOptions() {
  comms::SenderOptions sender;
  sender.bytes_per_s = options_.budget;
  // A third more of the map by landing than the other way round: docs/benchmarks.md.
  sender.queue.topics_weight = 4;
  sender.queue.bricks_weight = 8;
  sender.stamp = [](comms::Packet& packet, int64_t now_us) { wire::stampTime(packet.bytes, {now_us}); };
  sender.join = [this](std::span<const comms::SendQueue::Next> together) { return join(together); };
  sender.most_joined_bytes =
      mostBytesOn(channelOf(name_, wire::MessageKind::kCertainty), options_.budget, trailer_);
  sender.make_heartbeat = [this](int64_t now_us) -> comms::Packet {
    const std::string channel = channelOf(name_, wire::MessageKind::kHeartbeat);
    return {channel, wire::encode(options_.make_heartbeat(now_us), wire::maxPayload(channel.size()))};
  };
  return sender;
}

std::string Voice::queueKey(const mapping::PieceKey& key, int32_t part) {
  std::string text = std::to_string(static_cast<int>(key.kind));
  for (const int32_t i : key.index) text += '/' + std::to_string(i);
  return text + '/' + std::to_string(part);
}

void Voice::say(const mapping::Piece& part, wire::Bytes message) {
  said_.apply(part);
  state_.apply(part);
  offer(part, std::move(message));
}

void Voice::offer(const mapping::Piece& part, wire::Bytes message) {
  const std::string key = queueKey(part.key, part.part);
  sender_.offer(trafficOf(part.key.kind), key, {channelOf(name_, wire::kindOf(part)), std::move(message)});
  offered_.insert_or_assign(key, part);
}

void Voice::forget(const mapping::PieceKey& key, int32_t part) {
  const std::string text = queueKey(key, part);
  sender_.forget(text);
  offered_.erase(text);
}

bool Voice::isWaiting(const mapping::Piece& piece) const {
  return piece.key.robot == options_.robot && sender_.queue().isWaiting(queueKey(piece.key, piece.part));
}

size_t Voice::mostBytes(const mapping::Piece& piece) const {
  return mostBytesOn(channelOf(name_, wire::kindOf(piece)), cut_.budget, static_cast<size_t>(cut_.trailer));
}

// Topics and bricks that wait share datagrams.
std::optional<comms::Packet> Voice::join(std::span<const comms::SendQueue::Next> together) const {
  std::vector<const mapping::Piece*> pieces;
  for (const comms::SendQueue::Next& each : together) {
    const auto offered = offered_.find(each.key);
    if (offered == offered_.end()) return std::nullopt;  // a request or a repair
    pieces.push_back(&offered->second);
  }
  auto bytes = wire::encodeTogether(pieces, options_.mission);
  if (!bytes) return std::nullopt;
  return comms::Packet{together.front().packet->channel, std::move(*bytes)};
}

void Voice::saveTo(Checkpoint& checkpoint) const {
  checkpoint.cut = cut_;
  said_.visit([&](const mapping::Piece& piece) {
    const std::string key = queueKey(piece.key, piece.part);
    const comms::Packet* held = sender_.queue().held(key);
    checkpoint.said.push_back({piece, sender_.queue().isWaiting(key), held ? held->bytes : wire::Bytes{}});
  });
}

void Voice::restore(const Checkpoint& checkpoint) {
  cut_ = checkpoint.cut;
  for (const Checkpoint::Said& said : checkpoint.said) {
    said_.apply(said.piece);
    state_.apply(said.piece);
    if (said.waits) offer(said.piece, wire::encode(said.piece, options_.mission, {}));
  }
}

void Voice::report(wire::Heartbeat& h) const {
  uint64_t rejected = 0;
  for (const auto& [reason, count] : sender_.stats().rejected) rejected += count;
  h.own_digest = said_.digestOf(options_.robot);
  if (wire::hasLanded(h.phase)) h.learnt = wire::shareDigest(said_.learntDigestOf(options_.robot));
  h.bytes_sent = static_cast<int64_t>(sender_.stats().linkBytes());
  h.budget = static_cast<int32_t>(options_.budget);
  h.queue_bytes = static_cast<int32_t>(std::min<int64_t>(sender_.backlog(), INT32_MAX));
  h.rejected = static_cast<int32_t>(std::min<uint64_t>(rejected, INT32_MAX));
  for (size_t i = 0; i < wire::Heartbeat::kNumClasses; ++i)
    h.class_bytes[i] = static_cast<int64_t>(sender_.stats().sent[i].bytes);
}

}  // namespace shoal::robot_agent
