// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "fusion_node/twin_watch.h"
#include "shoal/comms/stats.h"
#include "shoal/mapping/events_answer.h"
#include "shoal/wire/heartbeat_codec.h"

namespace shoal::fusion_node {

/// What happened to the nodes of a mission, from their heartbeats and from what was refused. Bounded: the
/// oldest events go, and repeated refusals are told at 1, 10, 100, ...
class EventLog {
 public:
  /// Wall time, seconds, any origin, growing. Who was not heard for long by it is lost: ten seconds, or on a
  /// thin budget four times as long as its heartbeats may take.
  void passTime(double wall_s);

  void heard(const std::string& node, const wire::Heartbeat& heartbeat);

  /// After something was heard on `channel`: tells what was refused since the last call.
  void refused(const std::string& channel, const comms::Stats& stats);

  void otherMission(int32_t mission);

  /// In place of what is told so far: what was told in an earlier life. Nodes that were heard in it count as
  /// heard now.
  void restore(const std::vector<mapping::MissionEvent>& events);

  std::vector<mapping::MissionEvent> events() const { return {events_.begin(), events_.end()}; }

 private:
  struct Node {
    wire::Heartbeat last;
    double wall_s = 0;
    bool lost = false;
    bool twin = false;
  };
  void add(double at_s, std::string kind, std::string node, std::string says);

  std::map<std::string, Node> nodes_;
  TwinWatch twins_;
  std::map<std::string, uint64_t> refusals_;                      // by reason, as last seen
  std::map<std::pair<std::string, std::string>, uint64_t> told_;  // by channel and reason
  std::deque<mapping::MissionEvent> events_;
  double wall_s_ = 0, latest_s_ = 0;
};

}  // namespace shoal::fusion_node
