// SPDX-License-Identifier: BSD-3-Clause
#include "robot_agent/listener.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>

#include <spdlog/spdlog.h>

#include "fusion_node/process.h"

namespace shoal::robot_agent {
namespace {

int64_t wallMs() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

Listener::Listener(const ListenerOptions& options, comms::Bus& bus, comms::MissionClock& clock,
                   fusion_node::MissionState& state, Voice& voice)
    : options_(options),
      name_(name(options.robot)),
      bus_(bus),
      clock_(clock),
      state_(state),
      voice_(voice),
      repair_({name_, options.mission, options.budget, number(options.robot), options.fuses,
               [&voice](const mapping::Piece& piece) { return voice.isWaiting(piece); }, options.make_wanted},
              state, voice.sender()),
      silence_(options.budget, wallMs()) {}

void Listener::hear(int timeout_ms) {
  const std::string own = "SHOAL_" + name_ + "_";
  bus_.receive(timeout_ms, [&](const comms::Packet& packet) {
    if (!packet.channel.starts_with(own)) silence_.heard(wallMs());
    state_.hear(packet, voice_.sender().stats());
    repair_.hear(packet, clock_.now());
  });
}

void Listener::warn() {
  if (const auto warning = silence_.check(wallMs())) spdlog::warn("{}", *warning);
  for (; warned_of_missions_ < state_.otherMissions().size(); ++warned_of_missions_) {
    spdlog::warn("another mission is heard on this URL; ours is {}", options_.mission);
  }
  const auto twin = state_.heartbeats().find(name_);
  if (!warned_of_twin_ && twin != state_.heartbeats().end() &&
      (twin->second.pid != ::getpid() || twin->second.host != fusion_node::hostHash())) {
    spdlog::error("another process (pid {}) also calls itself {}", twin->second.pid, name_);
    warned_of_twin_ = true;
  }
}

bool Listener::isHeard() {
  bool is_held = false, has_left = false, is_silent = false;
  for (const auto& [node, heartbeat] : state_.heartbeats()) {
    const bool fuses = heartbeat.phase == wire::Phase::kNode || heartbeat.map_of_state != 0;
    if (node == name_ || !fuses || heartbeat.roster.empty()) continue;
    const auto mine = std::ranges::find(heartbeat.roster, options_.robot, &wire::Heartbeat::Share::robot);
    if (mine != heartbeat.roster.end() &&
        mine->digest == wire::shareDigest(voice_.said().digestOf(options_.robot))) {
      is_held = true;
    } else if (heartbeat.phase == wire::Phase::kLeaving) {
      has_left = true;
    } else if (!repair_.hears(node, clock_.now())) {
      is_silent = true;
    } else {
      return false;
    }
  }
  return is_held || (options_.fuses && has_left && !is_silent);
}

void Listener::report(wire::Heartbeat& h, int64_t now_us) {
  h.state_digest = options_.fuses ? state_.beliefs().digest() : voice_.said().digest();
  if (options_.fuses) {
    h.map_digest = state_.mapDigest();
    h.map_of_state = state_.fused().stateDigest();
  }
  h.roster = repair_.roster(now_us);
  h.conflicts = state_.conflicts() + (warned_of_twin_ ? 1 : 0);
}

}  // namespace shoal::robot_agent
