// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/mission_watch.h"

#include <algorithm>

#include "operator_console/agreement.h"
#include "shoal/comms/channels.h"
#include "shoal/random.h"
#include "shoal/wire/message_kind.h"
#include "shoal/world/ids.h"

namespace shoal::console {
namespace {

constexpr const char* kOperator = "OPERATOR";

// A hostile peer must not make us remember without end.
constexpr size_t kMaxNodes = 600;

}  // namespace

MissionWatch::MissionWatch(int32_t mission, int num_robots, int64_t budget)
    : mission_(mission), budget_(budget), state_(mission, {}) {
  for (int robot = 0; robot < num_robots; ++robot) robots_.push_back(world::name(world::RobotId{robot}));
}

void MissionWatch::hear(const comms::Packet& packet) {
  const auto channel = comms::parseChannel(packet.channel);
  const auto header = wire::peek(packet.bytes);
  if (!channel || !header || wire::channelKind(header->kind) != channel->kind) return;
  const bool is_ours = header->mission == mission_;
  if (!is_ours || header->kind == wire::MessageKind::kHeartbeat) state_.hear(packet, refused_);
  // The whole map goes to this host alone, not over the link.
  if (!is_ours || header->kind == wire::MessageKind::kMap) return;
  if (!sent_.contains(channel->node) && sent_.size() >= kMaxNodes) return;
  int64_t& last_us = last_sent_us_[channel->node];
  last_us = std::max(last_us, header->time.us);
  sent_.try_emplace(channel->node, budget_).first->second.add(header->time.us, comms::wireSize(packet));
}

const wire::Heartbeat* MissionWatch::find(const std::string& node) const {
  const auto found = nodes().find(node);
  return found == nodes().end() ? nullptr : &found->second;
}

bool MissionWatch::holdsWhole(const wire::Heartbeat& fusing, const std::string& name) const {
  const wire::Heartbeat* robot = find(name);
  if (!robot || robot->own_digest == 0) return true;  // it has nothing to say
  const auto id = world::parseRobotId(name);
  const auto share = std::ranges::find(fusing.roster, *id, &wire::Heartbeat::Share::robot);
  return share != fusing.roster.end() && share->digest == wire::shareDigest(robot->own_digest);
}

std::vector<mapping::NodeStatus> MissionWatch::statuses() const {
  std::vector<mapping::NodeStatus> statuses = state_.view().nodes;
  const wire::Heartbeat* home = find(kOperator);
  for (mapping::NodeStatus& status : statuses) {
    status.heard_whole = home && (!world::parseRobotId(status.name) || holdsWhole(*home, status.name));
  }
  return statuses;
}

std::optional<int32_t> MissionWatch::otherMission() const {
  if (state_.otherMissions().empty()) return std::nullopt;
  return *state_.otherMissions().begin();
}

std::vector<std::string> MissionWatch::unheard() const {
  std::vector<std::string> unheard;
  if (!find(kOperator)) unheard.push_back(kOperator);
  for (const std::string& robot : robots_) {
    if (!find(robot)) unheard.push_back(robot);
  }
  return unheard;
}

bool MissionWatch::allLanded(const std::string& other_than) const {
  return std::ranges::all_of(robots_, [&](const std::string& name) {
    if (name == other_than) return true;
    const wire::Heartbeat* robot = find(name);
    return robot && hasLanded(*robot);
  });
}

void MissionWatch::addLacking(const std::string& node, const wire::Heartbeat& fusing,
                              std::vector<std::string>& lacking) const {
  for (const std::string& name : robots_) {
    if (!holdsWhole(fusing, name)) lacking.push_back(node + " does not hold all of " + name);
  }
  if (fusing.map_of_state != fusing.state_digest) lacking.push_back(node + " has not fused what it holds");
}

std::vector<std::string> MissionWatch::lacking() const {
  std::vector<std::string> lacking;
  for (const std::string& name : robots_) {
    const wire::Heartbeat* robot = find(name);
    if (!robot) {
      lacking.push_back(name + " was not heard");
    } else if (!hasLanded(*robot)) {
      lacking.push_back(name + " has not landed");
    } else if (robot->phase == wire::Phase::kListening) {
      lacking.push_back(name + " has yet to look again at its map");
    }
  }
  const wire::Heartbeat* home = find(kOperator);
  if (!home) {
    lacking.push_back("OPERATOR was not heard");
    return lacking;
  }
  addLacking(kOperator, *home, lacking);
  for (const auto& [name, node] : nodes()) {
    if (name == kOperator || node.map_of_state == 0) continue;  // it does not fuse
    addLacking(name, node, lacking);
    if (node.state_digest != home->state_digest) {
      lacking.push_back(name + " holds another state than OPERATOR");
    } else if (node.map_of_state == home->map_of_state && node.map_digest != home->map_digest) {
      lacking.push_back(name + " made another map than OPERATOR from the same state");
    }
  }
  return lacking;
}

uint64_t MissionWatch::progress() const {
  uint64_t hash = nodes().size();
  for (const auto& [name, node] : nodes()) {
    for (const uint64_t value : {static_cast<uint64_t>(node.phase), static_cast<uint64_t>(node.observation),
                                 node.own_digest, node.state_digest, node.map_of_state, node.map_digest}) {
      hash = hashCombine(hash, value);
    }
  }
  return hash;
}

uint64_t MissionWatch::stateDigest() const {
  const wire::Heartbeat* home = find(kOperator);
  return home ? home->state_digest : 0;
}

uint64_t MissionWatch::mapDigest() const {
  const wire::Heartbeat* home = find(kOperator);
  return home ? home->map_digest : 0;
}

double MissionWatch::missionTime() const {
  world::Timestamp latest;
  for (const auto& [name, node] : nodes()) latest = std::max(latest, node.time);
  return latest.seconds();
}

double MissionWatch::lastSentAt(const std::string& node) const {
  const auto found = last_sent_us_.find(node);
  return found == last_sent_us_.end() ? 0 : static_cast<double>(found->second) * 1e-6;
}

MissionWatch::WorstWindow MissionWatch::worstWindow() const {
  WorstWindow worst;
  for (const auto& [node, meter] : sent_) {
    const comms::MeteredWindow window = meter.worst();
    const bool more = budget_ > 0 ? window.share > worst.window.share : window.bytes > worst.window.bytes;
    if (worst.node.empty() || more) worst = {node, window};
  }
  return worst;
}

}  // namespace shoal::console
