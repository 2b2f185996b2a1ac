// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/node_memory.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <string_view>

#include "fusion_node/limits.h"
#include "shoal/comms/channels.h"
#include "shoal/comms/log_reader.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/wire/message_kind.h"
#include "shoal/wire/piece_codec.h"

namespace shoal::fusion_node {
namespace {

constexpr uint64_t kLeastRewriteBytes = 4'000'000;
constexpr int64_t kHeartbeatEveryUs = 10'000'000;

int64_t wallUs() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace

NodeMemory::NodeMemory(std::string folder, std::string node, int32_t mission)
    : path_(std::move(folder) + "/heard.lcmlog"),
      node_(std::move(node)),
      mission_(mission),
      rewrite_at_bytes_(kLeastRewriteBytes) {}

std::optional<std::pair<int64_t, int64_t>> NodeMemory::recall(MissionState& state) {
  std::optional<std::pair<int64_t, int64_t>> clock;
  if (std::filesystem::exists(path_)) {
    const std::string own = comms::channelName(node_, "HEARTBEAT");
    comms::Stats passed_over;
    comms::LogReader log(path_);
    while (const auto event = log.next()) {
      const auto header = wire::peek(event->packet.bytes);
      if (!header || header->mission != mission_) continue;  // of a mission before
      state.hear(event->packet, passed_over);
      if (event->packet.channel == own) clock = {header->time.us, event->time_us};
    }
  }
  log_.emplace(path_);
  rewrite_at_bytes_ = std::max(kLeastRewriteBytes, 4 * log_->bytes());
  return clock;
}

void NodeMemory::keep(const comms::Packet& packet, bool is_new, const MissionState& state) {
  if (!log_) return;
  if (packet.channel.ends_with("_HEARTBEAT")) {
    const auto header = wire::peek(packet.bytes);
    if (!header || header->mission != mission_) return;
    if (!heartbeat_kept_us_.contains(packet.channel) && heartbeat_kept_us_.size() >= kMaxNodes) return;
    const auto [kept, first] = heartbeat_kept_us_.try_emplace(packet.channel, header->time.us);
    if (!first && header->time.us - kept->second < kHeartbeatEveryUs) return;
    kept->second = header->time.us;
  } else if (!is_new) {
    return;
  }
  log_->append(packet, wallUs());
  if (log_->bytes() > rewrite_at_bytes_) rewrite(state);
}

void NodeMemory::rewrite(const MissionState& state) {
  comms::Bytes out;
  uint64_t number = 0;
  const int64_t now_us = wallUs();
  for (const auto& [node, heartbeat] : state.heartbeats()) {
    const std::string channel = comms::channelName(node, "HEARTBEAT");
    comms::appendLogEvent(out, {channel, wire::encode(heartbeat)}, number++, now_us);
  }
  state.beliefs().visit([&](const mapping::Piece& piece) {
    const bool is_edit = piece.key.robot == mapping::kOperators;
    const std::string channel = comms::channelName(is_edit ? node_ : world::name(piece.key.robot),
                                                   wire::channelKind(wire::kindOf(piece)));
    comms::appendLogEvent(out, {channel, wire::encode(piece, mission_, {})}, number++, now_us);
  });
  log_.reset();
  mapping::writeFileAtomically(path_, {reinterpret_cast<const char*>(out.data()), out.size()});
  log_.emplace(path_);
  rewrite_at_bytes_ = std::max(kLeastRewriteBytes, 4 * log_->bytes());
}

}  // namespace shoal::fusion_node
