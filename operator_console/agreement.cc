// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/agreement.h"

#include <algorithm>

#include "shoal/world/ids.h"

namespace shoal::console {
namespace {

using Nodes = std::map<std::string, wire::Heartbeat>;

bool isRobot(const Nodes::value_type& node) {
  return node.second.phase != wire::Phase::kNode && world::parseRobotId(node.first).has_value();
}

bool fuses(const wire::Heartbeat& node) { return node.phase == wire::Phase::kNode || node.map_of_state != 0; }

bool holdsWhole(const wire::Heartbeat& fusing, const Nodes::value_type& robot) {
  if (robot.second.own_digest == 0) return true;  // it has nothing to say
  const auto share =
      std::ranges::find(fusing.roster, *world::parseRobotId(robot.first), &wire::Heartbeat::Share::robot);
  return share != fusing.roster.end() && share->digest == wire::shareDigest(robot.second.own_digest);
}

bool allLanded(const Nodes& nodes) {
  bool any = false;
  for (const auto& node : nodes) {
    if (!isRobot(node)) continue;
    if (!hasLanded(node.second)) return false;
    any = true;
  }
  return any;
}

double furthestClock(const Nodes& nodes) {
  world::Timestamp latest;
  for (const auto& [name, node] : nodes) latest = std::max(latest, node.time);
  return latest.seconds();
}

}  // namespace

bool hasLanded(const wire::Heartbeat& robot) {
  return robot.phase != wire::Phase::kFlying && robot.phase != wire::Phase::kNode;
}

std::vector<std::string> disagreements(const Nodes& nodes) {
  std::vector<std::string> lines;
  const Nodes::value_type* first = nullptr;
  bool robots = false;
  for (const auto& node : nodes) {
    if (isRobot(node)) {
      robots = true;
      if (!hasLanded(node.second)) lines.push_back(node.first + " has not landed");
      if (node.second.phase == wire::Phase::kListening)
        lines.push_back(node.first + " has yet to look again at its map");
    }
    if (!fuses(node.second)) continue;
    if (first == nullptr) first = &node;
    for (const auto& robot : nodes) {
      if (isRobot(robot) && !holdsWhole(node.second, robot)) {
        lines.push_back(node.first + " does not hold all of " + robot.first);
      }
    }
    if (node.second.map_of_state != node.second.state_digest) {
      lines.push_back(node.first + " has not fused what it holds");
    }
    if (node.second.state_digest != first->second.state_digest) {
      lines.push_back(node.first + " holds another state than " + first->first);
    } else if (node.second.map_of_state == first->second.map_of_state &&
               node.second.map_digest != first->second.map_digest) {
      lines.push_back(node.first + " made another map than " + first->first + " from the same state");
    }
  }
  if (!robots) lines.push_back("no robot was heard");
  if (first == nullptr) lines.push_back("no node that fuses was heard");
  return lines;
}

void Agreement::update(const Nodes& nodes) {
  if (!allLanded(nodes)) {
    landed_s_.reset();
    agreed_s_.reset();
    return;
  }
  if (!landed_s_) landed_s_ = furthestClock(nodes);
  if (!disagreements(nodes).empty()) {
    agreed_s_.reset();
  } else if (!agreed_s_) {
    agreed_s_ = furthestClock(nodes);
  }
}

}  // namespace shoal::console
