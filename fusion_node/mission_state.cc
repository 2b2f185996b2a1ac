// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/mission_state.h"

#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include "fusion_node/authentication.h"
#include "fusion_node/limits.h"
#include "shoal/comms/channels.h"
#include "shoal/comms/sender.h"
#include "shoal/mapping/common_settings.h"
#include "shoal/mapping/judgement.h"
#include "shoal/wire/message_kind.h"
#include "shoal/wire/piece_codec.h"
#include "shoal/wire/repair_codec.h"

namespace shoal::fusion_node {
namespace {

constexpr size_t kMaxOtherMissions = 16;

std::string_view phaseName(wire::Phase phase) {
  switch (phase) {
    case wire::Phase::kFlying:
      return "flying";
    case wire::Phase::kLanded:
      return "landed";
    case wire::Phase::kLeaving:
      return "leaving";
    case wire::Phase::kNode:
      return "node";
    case wire::Phase::kListening:
      return "listening";
  }
  return "unknown";
}

std::string agreement(const wire::Heartbeat& h, const Digests& ours) {
  if (h.map_of_state == 0 && h.map_digest == 0) return "none";
  if (h.map_of_state != ours.state) return "behind";
  return h.map_digest == ours.map ? "same" : "other";
}

// Of what nodes do to repair the state, a heartbeat holds the sum alone: the rest of all bytes.
std::map<std::string, int64_t> classBytes(const wire::Heartbeat& h) {
  std::map<std::string, int64_t> sent;
  int64_t rest = h.bytes_sent;
  for (size_t i = 0; i < wire::Heartbeat::kNumClasses; ++i) {
    if (comms::TrafficClass{static_cast<uint8_t>(i)} == comms::TrafficClass::kLocal)
      continue;  // not on the link
    sent[std::string(comms::kTrafficClassNames[i])] = h.class_bytes[i];
    rest -= std::min(rest, h.class_bytes[i]);
  }
  sent["repair"] = rest;
  return sent;
}

}  // namespace

mapping::NodeStatus statusOf(const std::string& node, const wire::Heartbeat& h, bool heard_whole,
                             const Digests& ours) {
  return {.name = node,
          .phase = std::string(phaseName(h.phase)),
          .heard_s = h.time.seconds(),
          .observation = h.observation,
          .num_observations = h.num_observations,
          .topics = h.num_topics,
          .cells = h.num_cells,
          .bytes_sent = h.bytes_sent,
          .budget = h.budget,
          .queue_bytes = h.queue_bytes,
          .clear_s = h.budget > 0 ? h.queue_bytes / comms::contentPerSecond(h.budget) : 0,
          .ms_per_frame = h.ms_per_frame,
          .x_m = h.x_m,
          .y_m = h.y_m,
          .z_m = h.z_m,
          .rejected = h.rejected,
          .conflicts = h.conflicts,
          .battery_percent = h.battery_percent < 0 ? std::nullopt : std::optional(h.battery_percent),
          .depth_m = h.depth_cm < 0 ? std::nullopt : std::optional(h.depth_cm / 100.0),
          .heard_whole = heard_whole,
          .agreement = agreement(h, ours),
          .class_bytes = classBytes(h)};
}

MissionState::MissionState(int32_t mission, const matching::MatcherOptions& matcher, double cell_size_m,
                           const mapping::StoreLimits& limits)
    : mission_(mission), matcher_(matcher), cell_size_m_(cell_size_m), beliefs_(limits) {
  matching::match(matching::DescriptorSet{}, matcher_);  // wrong options are the caller's mistake: say so now
}

bool MissionState::hear(const comms::Packet& packet, comms::Stats& stats) {
  const bool news = takeIn(packet, stats, true);
  if (const auto channel = comms::parseChannel(packet.channel);
      channel && channel->kind != "MAP")  // not of the link
    links_.heard(channel->node, comms::wireSize(packet));
  events_.refused(packet.channel, stats);
  return news;
}

bool MissionState::recall(const comms::Packet& packet, comms::Stats& stats) {
  const bool news = takeIn(packet, stats, false);
  events_.refused(packet.channel, stats);
  return news;
}

bool MissionState::takeIn(const comms::Packet& packet, comms::Stats& stats, bool is_live) {
  const auto refuse = [&stats](std::string_view reason) {
    stats.countRejected(reason);
    return false;
  };
  const auto channel = comms::parseChannel(packet.channel);
  if (!channel) return refuse("channel");
  const auto header = wire::peek(packet.bytes);
  if (!header) return refuse(wire::name(header.error()));
  if (wire::channelKind(header->kind) != channel->kind) return refuse("wrong type");
  if (isSealed(packet)) {  // what a key let pass has no seal any more
    if (sealed_nodes_.size() < kMaxNodes || sealed_nodes_.contains(channel->node)) {
      ++sealed_nodes_[channel->node];
    }
    return refuse("sealed");
  }
  if (header->mission != mission_) {
    if (other_missions_.size() < kMaxOtherMissions && other_missions_.insert(header->mission).second) {
      events_.otherMission(header->mission);
    }
    return refuse("other mission");
  }
  switch (header->kind) {
    case wire::MessageKind::kHeartbeat: {
      const auto heartbeat = wire::decodeHeartbeat(packet.bytes);
      if (!heartbeat) return refuse(wire::name(heartbeat.error()));
      if (!heartbeats_.contains(channel->node) && heartbeats_.size() >= kMaxNodes) {
        return refuse("too many nodes");
      }
      events_.heard(channel->node, *heartbeat);
      if (const auto robot = world::parseRobotId(channel->node)) {
        clocks_.heard(channel->node, heartbeat->time.us);
        beliefs_.noteEpoch(*robot, heartbeat->epoch);
      }
      twins_.heard(channel->node, *heartbeat);
      if (is_live) links_.claimed(channel->node, *heartbeat);
      wire::Heartbeat& held = heartbeats_[channel->node];
      const auto age = [](const wire::Heartbeat& h) { return std::pair(h.epoch, h.time); };
      if (age(*heartbeat) >= age(held)) held = *heartbeat;
      SentBytes& sent = sent_[channel->node];
      sent.heard(*heartbeat);
      const SentBytes::Sum sum = sent.sum();
      held.bytes_sent = sum.bytes;
      held.class_bytes = sum.of_class;
      latest_ = std::max(latest_, heartbeat->time);
      return false;
    }
    case wire::MessageKind::kTopics:
    case wire::MessageKind::kBrick:
    case wire::MessageKind::kCertainty:
    case wire::MessageKind::kPicture:
    case wire::MessageKind::kSettings:
    case wire::MessageKind::kEdit: {
      const auto pieces = wire::decodePieces(header->kind, packet.bytes);
      if (!pieces) return refuse(wire::name(pieces.error()));
      bool news = false;
      for (const mapping::Piece& piece : *pieces) {
        const bool is_edit = piece.key.robot == mapping::kOperators;  // whoever made it, any node may say it
        if (!is_edit && name(piece.key.robot) != channel->node) return refuse("wrong sender");
        if (take(piece, false, stats)) news = true;
      }
      return news;
    }
    case wire::MessageKind::kRepair: {  // whoever made it, any node may say it
      const auto piece = wire::decodeRepair(packet.bytes);
      if (!piece) return refuse(wire::name(piece.error()));
      return take(*piece, true, stats);
    }
    default:
      return false;  // what fusion nodes publish for people is not part of the state
  }
}

bool MissionState::take(const mapping::Piece& piece, bool repaired, comms::Stats& stats) {
  const mapping::Applied applied = apply(piece);
  if (on_piece_) on_piece_(piece, repaired);
  if (applied == mapping::Applied::kConflict) stats.countRejected("conflict");
  if (applied == mapping::Applied::kRejected) stats.countRejected("over limit");
  return applied == mapping::Applied::kNew || applied == mapping::Applied::kPending;
}

mapping::Applied MissionState::apply(const mapping::Piece& piece) {
  const auto owner = heartbeats_.find(name(piece.key.robot));
  if (owner != heartbeats_.end() && piece.version.epoch < owner->second.epoch) return mapping::Applied::kOld;
  const mapping::Applied applied = beliefs_.apply(piece);
  if (applied == mapping::Applied::kConflict) ++conflicts_;
  return applied;
}

const mapping::FusedMap& MissionState::refresh() {
  if (mapIsStale()) {
    fused_.update(beliefs_, matcher_);
    map_is_old_ = true;
  }
  return fused_;
}

const mapping::GlobalMap& MissionState::refreshMap() {
  refresh();
  return map();
}

const mapping::GlobalMap& MissionState::map() const {
  if (map_is_old_) map_ = fused_.map();
  map_is_old_ = false;
  return map_;
}

std::vector<wire::Heartbeat::Share> MissionState::roster() const {
  std::vector<wire::Heartbeat::Share> roster;
  for (const world::RobotId robot : beliefs_.robots()) {
    roster.push_back({robot, wire::shareDigest(beliefs_.digestOf(robot))});
  }
  return roster;
}

bool MissionState::holdsWhole(const std::string& robot) const {
  const auto id = world::parseRobotId(robot);
  const auto said = heartbeats_.find(robot);
  return id && said != heartbeats_.end() && said->second.own_digest == beliefs_.digestOf(*id);
}

bool MissionState::holdsLearnt(const std::string& robot) const {
  const auto id = world::parseRobotId(robot);
  const auto said = heartbeats_.find(robot);
  return id && said != heartbeats_.end() && wire::hasLanded(said->second.phase) &&
         said->second.learnt == wire::shareDigest(beliefs_.learntDigestOf(*id));
}

double MissionState::cellSize() const {
  if (const auto common = commonSettings(beliefs_, mapping::judge(beliefs_).excluded))
    return common->cell_size_m;
  for (const auto& [name, heartbeat] : heartbeats_)
    if (heartbeat.phase != wire::Phase::kNode) return heartbeat.cell_size_m;
  return cell_size_m_;
}

std::vector<mapping::Mixture> MissionState::mixtures() const {
  std::vector<mapping::Mixture> mixed;
  for (const auto& [name, heartbeat] : heartbeats_) {
    const auto skew = clocks_.skewOf(name);
    if (!skew || std::abs(*skew) <= clock_tolerance_s_) continue;
    mixed.push_back(
        {"clock", name,
         fmt::format("the clock of {} is {:.0f} s {} the other robots': what it saw counts as {} than "
                     "it is",
                     name, std::abs(*skew), *skew > 0 ? "ahead of" : "behind",
                     *skew > 0 ? "newer" : "older")});
  }
  if (conflicts_ > 0) {
    mixed.push_back({"conflict", "",
                     fmt::format("{} pieces differ from others of the same version: two processes with one "
                                 "robot's name",
                                 conflicts_)});
  }
  for (const int32_t mission : other_missions_)
    mixed.push_back({"mission", "", fmt::format("mission {} is heard on the same URL", mission)});
  const auto common = commonSettings(beliefs_, mapping::judge(beliefs_).excluded);
  for (const world::RobotId robot : beliefs_.robots()) {
    const mapping::Comparable comparable = compare(beliefs_, robot, common);
    if (robot == mapping::kOperators || comparable == mapping::Comparable::kSame ||
        comparable == mapping::Comparable::kUnknown)
      continue;
    const bool cells = comparable == mapping::Comparable::kOtherCells;
    mixed.push_back({"settings", name(robot),
                     fmt::format("{} has {} than most of the team: its {}", name(robot), toText(comparable),
                                 cells ? "cells are left out of the map" : "topics are not matched")});
  }
  for (const auto& [name, heartbeat] : heartbeats_) {
    if (twins_.hasTwin(name)) mixed.push_back({"twin", name, "two processes speak as " + name + " by turns"});
  }
  return mixed;
}

mapping::MissionView MissionState::view() const {
  mapping::MissionView view = overview();
  view.map = map();
  return view;
}

mapping::MissionView MissionState::overview() const {
  mapping::MissionView view{.mission = mission_,
                            .cell_size_m = cellSize(),
                            .map = {.cells = {},
                                    .correspondences = fused_.correspondences(),
                                    .labels = fused_.labels(),
                                    .state_digest = fused_.stateDigest()},
                            .state_digest = beliefs_.digest(),
                            .map_digest = mapDigest(),
                            .nodes = {}};
  const auto common = commonSettings(beliefs_, mapping::judge(beliefs_).excluded);
  for (const auto& [name, h] : heartbeats_) {
    view.nodes.push_back(statusOf(name, h, holdsWhole(name), {fused_.stateDigest(), mapDigest()}));
    view.nodes.back().clock_skew_s = clocks_.skewOf(name);
    view.nodes.back().heard_share = links_.shareOf(name);
    if (const auto robot = world::parseRobotId(name))
      view.nodes.back().settings = toText(compare(beliefs_, *robot, common));
  }
  view.mixed = mixtures();
  for (const auto& [name, messages] : sealed_nodes_) view.strangers.push_back({name, "a key", messages});
  std::ranges::stable_sort(view.nodes, {}, [](const mapping::NodeStatus& n) {
    const auto robot = world::parseRobotId(n.name);
    return std::pair(robot ? number(*robot) : INT32_MAX, n.name);
  });
  return view;
}

}  // namespace shoal::fusion_node
