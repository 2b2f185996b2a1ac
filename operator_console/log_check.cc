// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/log_check.h"

#include "fusion_node/mission_state.h"
#include "shoal/comms/log_reader.h"
#include "shoal/world/ids.h"

namespace shoal::console {

std::vector<std::string> lackingInLog(const std::string& path, int32_t mission, uint64_t state_digest,
                                      const std::map<std::string, wire::Heartbeat>& heartbeats) {
  fusion_node::MissionState state(mission, {});
  comms::Stats refused;
  comms::LogReader log(path);
  while (const auto event = log.next()) state.hear(event->packet, refused);

  std::vector<std::string> lacking;
  for (const auto& [node, heartbeat] : heartbeats) {
    const auto robot = world::parseRobotId(node);
    if (robot && state.beliefs().digestOf(*robot) != heartbeat.own_digest) {
      lacking.push_back(path + " does not hold all of " + node);
    }
  }
  if (lacking.empty() && state.beliefs().digest() != state_digest) {
    lacking.push_back(path + " adds up to another state than OPERATOR's");
  }
  return lacking;
}

}  // namespace shoal::console
