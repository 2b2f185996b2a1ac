// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/node_memory.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "fusion_node/limits.h"
#include "shoal/wire/heartbeat_codec.h"
#include "shoal/wire/message_kind.h"
#include "shoal/world/mission_time.h"

namespace shoal::fusion_node {
namespace {

constexpr int64_t kHeartbeatEveryUs = 10'000'000;
constexpr int64_t kClockEveryUs = 2'000'000;
constexpr int64_t kLatestUs = world::kMaxTimeUs / 2;  // 73,000 years: what is later leaves no room to go on
const std::string kMissionUs = "mission_us", kWallUs = "wall_us", kBootUs = "boot_us", kBootId = "boot_id";

std::optional<int64_t> number(const std::string& text) {
  int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
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
    : path_(madeIn(folder, mission)), mission_(mission), file_(path_, node, mission) {}

std::optional<NodeMemory::Clock> NodeMemory::recall(MissionState& state) {
  comms::Stats passed_over;
  MissionFileReader file(path_);
  while (const auto event = file.next()) {
    const auto header = wire::peek(event->packet.bytes);
    if (header && header->mission == mission_) state.recall(event->packet, passed_over);
  }
  const std::vector<mapping::MissionEvent> events = file_.events();
  if (!events.empty()) last_event_ = events.back();
  state.restoreEvents(events);

  const auto mission_us = number(file_.get(kMissionUs)), wall_us = number(file_.get(kWallUs)),
             boot_us = number(file_.get(kBootUs));
  if (!mission_us || *mission_us < 0 || *mission_us > kLatestUs || !wall_us) return std::nullopt;
  return Clock{.mission_us = *mission_us,
               .spoken_until_us = *mission_us + kClockEveryUs,
               .at = {*wall_us, boot_us.value_or(0), boot_us ? file_.get(kBootId) : ""}};
}

void NodeMemory::keepClock(int64_t mission_us) {
  if (clock_us_ && mission_us < *clock_us_ + kClockEveryUs) return;
  clock_us_ = mission_us;
  const Moment now = thisMoment();
  file_.set(kMissionUs, std::to_string(mission_us));
  file_.set(kWallUs, std::to_string(now.wall_us));
  file_.set(kBootUs, std::to_string(now.boot_us));
  file_.set(kBootId, now.boot_id);
  file_.commit();
}

void NodeMemory::keep(const comms::Packet& packet, bool is_new) {
  if (packet.channel.ends_with("_HEARTBEAT")) {
    const auto heartbeat = wire::decodeHeartbeat(packet.bytes);
    if (!heartbeat || heartbeat->mission != mission_) return;
    if (!heartbeat_kept_.contains(packet.channel) && heartbeat_kept_.size() >= kMaxNodes) return;
    const Kept now{heartbeat->time.us, heartbeat->phase, {heartbeat->host, heartbeat->pid}};
    const auto [kept, first] = heartbeat_kept_.try_emplace(packet.channel, now);
    Kept& last = kept->second;
    if (!first && std::abs(now.time_us - last.time_us) < kHeartbeatEveryUs && now.phase == last.phase &&
        now.process == last.process) {
      if (last.left_out && now.time_us < last.left_out_us) return;  // late
      last.left_out = packet;
      last.left_out_us = now.time_us;
      return;
    }
    if (now.process != last.process && last.left_out) append(*last.left_out);  // what it had sent in all
    last = now;
  } else if (!is_new) {
    return;
  }
  append(packet);
}

void NodeMemory::keepLast() {
  for (auto& [channel, kept] : heartbeat_kept_) {
    if (kept.left_out) append(*kept.left_out);
    kept.left_out.reset();
  }
}

void NodeMemory::append(const comms::Packet& packet) {
  file_.append(packet, thisMoment().wall_us);
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
