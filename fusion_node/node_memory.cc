// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/node_memory.h"

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "fusion_node/limits.h"
#include "shoal/comms/channels.h"
#include "shoal/wire/heartbeat_codec.h"
#include "shoal/wire/message_kind.h"

namespace shoal::fusion_node {
namespace {

constexpr int64_t kHeartbeatEveryUs = 10'000'000;

int64_t wallUs() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::string madeIn(const std::string& folder, int32_t mission) {
  std::filesystem::create_directories(folder);
  return missionFilePath(folder, mission);
}

}  // namespace

std::string missionFilePath(const std::string& state_dir, int32_t mission) {
  return state_dir + "/mission-" + std::to_string(mission) + ".sqlite";
}

NodeMemory::NodeMemory(const std::string& folder, const std::string& node, int32_t mission)
    : path_(madeIn(folder, mission)), node_(node), mission_(mission), file_(path_, node, mission) {}

std::optional<std::pair<int64_t, int64_t>> NodeMemory::recall(MissionState& state) {
  std::optional<std::pair<int64_t, int64_t>> clock;
  const std::string own = comms::channelName(node_, "HEARTBEAT");
  comms::Stats passed_over;
  MissionFileReader file(path_);
  while (const auto event = file.next()) {
    const auto header = wire::peek(event->packet.bytes);
    if (!header || header->mission != mission_) continue;
    state.hear(event->packet, passed_over);
    if (event->packet.channel == own) clock = {header->time.us, event->time_us};
  }
  const std::vector<mapping::MissionEvent> events = file_.events();
  if (!events.empty()) last_event_ = events.back();
  state.restoreEvents(events);
  return clock;
}

void NodeMemory::keep(const comms::Packet& packet, bool is_new) {
  if (packet.channel.ends_with("_HEARTBEAT")) {
    const auto header = wire::peek(packet.bytes);
    if (!header || header->mission != mission_) return;
    if (!heartbeat_kept_.contains(packet.channel) && heartbeat_kept_.size() >= kMaxNodes) return;
    const auto heartbeat = wire::decodeHeartbeat(packet.bytes);
    const Kept now{header->time.us, heartbeat ? heartbeat->phase : wire::Phase::kFlying};
    const auto [kept, first] = heartbeat_kept_.try_emplace(packet.channel, now);
    if (!first && now.time_us - kept->second.time_us < kHeartbeatEveryUs && now.phase == kept->second.phase)
      return;
    kept->second = now;
  } else if (!is_new) {
    return;
  }
  file_.append(packet, wallUs());
  has_kept_ = true;
}

void NodeMemory::commit(const MissionState& state) {
  if (!has_kept_) return;
  has_kept_ = false;
  const std::vector<mapping::MissionEvent> events = state.events();
  auto fresh = events.begin();
  if (last_event_) {
    const auto known = std::find(events.rbegin(), events.rend(), *last_event_);
    fresh = known.base();  // all of them when it was so long ago that it is forgotten
  }
  for (; fresh != events.end(); ++fresh) {
    file_.append(*fresh);
    last_event_ = *fresh;
  }
  file_.commit();
}

}  // namespace shoal::fusion_node
