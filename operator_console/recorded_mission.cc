// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/recorded_mission.h"

#include <stdexcept>

namespace shoal::console {
namespace {

int32_t missionOf(const std::string& path, const std::string& key_file) {
  MessageLog log(path, key_file);
  while (const auto event = log.next()) {
    const auto header = wire::peek(event->packet.bytes);
    if (header && header->kind == wire::MessageKind::kHeartbeat) return header->mission;
  }
  throw std::runtime_error(path + " holds no heartbeat of a mission" +
                           (log.seals().refused > 0 ? " that this key sealed" : "; is it an LCM log?"));
}

int64_t total(const comms::Stats& stats) {
  int64_t refused = 0;
  for (const auto& [reason, count] : stats.rejected) refused += static_cast<int64_t>(count);
  return refused;
}

}  // namespace

RecordedMission readRecording(const std::string& path, const matching::MatcherOptions& matcher,
                              const OnMessage& on_message, std::optional<world::Timestamp> until,
                              const std::string& key_file) {
  const int32_t mission = missionOf(path, key_file);
  RecordedMission recorded{mission, {mission, matcher}, 0, 0};
  comms::Stats refused;
  MessageLog log(path, key_file);
  while (const auto event = log.next()) {
    if (!event->packet.channel.starts_with("SHOAL_")) continue;  // cameras, LCM's own self test
    const auto header = wire::peek(event->packet.bytes);
    if (until && header && header->time > *until) continue;
    recorded.state.passTime(static_cast<double>(event->time_us) * 1e-6);
    if (log.isMemory()) {
      recorded.state.recall(event->packet, refused);
    } else {
      recorded.state.hear(event->packet, refused);
    }
    if (const int64_t now_refused = total(refused); now_refused != recorded.refused) {
      recorded.refused = now_refused;
      continue;
    }
    ++recorded.messages;
    if (!on_message) continue;
    on_message(*comms::parseChannel(event->packet.channel), *header, event->packet, recorded.state);
  }
  recorded.seals = log.seals();
  recorded.refused += static_cast<int64_t>(log.counts().damaged + log.counts().large) + log.seals().refused;
  recorded.state.refreshMap();
  return recorded;
}

}  // namespace shoal::console
