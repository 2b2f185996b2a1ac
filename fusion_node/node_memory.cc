// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/node_memory.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <system_error>

#include "fusion_node/limits.h"
#include "shoal/comms/channels.h"
#include "shoal/wire/heartbeat_codec.h"
#include "shoal/wire/message_kind.h"

namespace shoal::fusion_node {
namespace {

constexpr int64_t kHeartbeatEveryUs = 10'000'000;
const std::string kBootId = "boot_id", kBootUs = "boot_us";  // of the last own heartbeat

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

std::optional<NodeMemory::Clock> NodeMemory::recall(MissionState& state) {
  std::optional<Clock> clock;
  const std::string own = comms::channelName(node_, "HEARTBEAT");
  comms::Stats passed_over;
  MissionFileReader file(path_);
  while (const auto event = file.next()) {
    const auto header = wire::peek(event->packet.bytes);
    if (!header || header->mission != mission_) continue;
    state.hear(event->packet, passed_over);
    if (event->packet.channel == own)
      clock = {.mission_us = header->time.us, .at = {.wall_us = event->time_us, .boot_us = 0, .boot_id = {}}};
  }
  const std::string boot_us = file_.get(kBootUs);
  if (clock &&
      std::from_chars(boot_us.data(), boot_us.data() + boot_us.size(), clock->at.boot_us).ec == std::errc{})
    clock->at.boot_id = file_.get(kBootId);
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
  const Moment now = thisMoment();
  file_.append(packet, now.wall_us);
  if (packet.channel == comms::channelName(node_, "HEARTBEAT")) {
    file_.set(kBootId, now.boot_id);
    file_.set(kBootUs, std::to_string(now.boot_us));
  }
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
