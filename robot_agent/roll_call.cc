// SPDX-License-Identifier: BSD-3-Clause
#include "robot_agent/roll_call.h"

#include <algorithm>

#include "shoal/mapping/judgement.h"

namespace shoal::robot_agent {
namespace {

// As long as a crashed robot takes to come back, and a multiple of what a thin budget leaves between two
// heartbeats, which take at most a tenth of it while content waits.
constexpr double kPatienceS = 60;
constexpr double kPatienceToMeetS = 15;
constexpr double kHeartbeatBytes = 250;

double patience(const wire::Heartbeat& h) {
  return h.budget > 0 ? std::max(kPatienceS, 10 * 10 * kHeartbeatBytes / h.budget) : kPatienceS;
}

}  // namespace

RollCall::RollCall(world::RobotId self, int32_t team_size, double wall_s) : self_(self) {
  for (int32_t robot = 0; robot < team_size; ++robot)
    if (world::RobotId{robot} != self)
      members_[world::RobotId{robot}] = {.heard_s = wall_s, .patience_s = kPatienceToMeetS, .said = {}};
}

void RollCall::look(const fusion_node::MissionState& heard, double wall_s) {
  excluded_ = mapping::judge(heard.beliefs()).excluded;
  for (const auto& [node, heartbeat] : heard.heartbeats()) {
    const auto robot = world::parseRobotId(node);
    if (!robot || *robot == self_ || heartbeat.phase == wire::Phase::kNode) continue;
    Member& member = members_[*robot];
    if (member.epoch != heartbeat.epoch || member.said != heartbeat.time) {
      if (member.epoch != heartbeat.epoch) member.is_known = false;
      member.epoch = heartbeat.epoch;
      member.said = heartbeat.time;
      member.heard_s = wall_s;
      member.patience_s = patience(heartbeat);
    }
    // Once is enough: what it has learnt changes no more, only what it makes of it.
    if (heard.holdsLearnt(node)) member.is_known = true;
  }
}

std::vector<std::string> RollCall::unknown(bool silent, double wall_s) const {
  std::vector<std::string> names;
  for (const auto& [robot, member] : members_) {
    const bool is_silent = wall_s - member.heard_s >= member.patience_s;
    if (!member.is_known && is_silent == silent && !excluded_.contains(robot))
      names.push_back(world::name(robot));
  }
  return names;
}

}  // namespace shoal::robot_agent
