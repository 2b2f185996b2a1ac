// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "operator_console/robot_tracks.h"
#include "shoal/mapping/queries.h"

namespace shoal::console {

/// What happened in a mission, in order: where robots were, what they sent, and what is worth telling.
/// Bounded: tracks and traffic get coarser as they grow, events stop at a number and say so.
class Chronicle {
 public:
  /// A node as its last heartbeat told it. Where classes of traffic are not known all counts as "sent".
  void hear(const mapping::NodeStatus& node);
  /// Where a node that was heard has been, better known than from what it told; ascending by time.
  void track(const std::string& node, const std::vector<TrackPoint>& points);
  /// The legend as it is at a time: new labels are events.
  void hearLabels(double time_s, const nlohmann::ordered_json& labels);
  /// The answer to `events`: who was lost and came back, twins, other missions, and what operators decided.
  /// What was told already is not told again.
  void hearEvents(const nlohmann::ordered_json& events);
  /// Something else worth telling. @param kind  "joined", "landed", "label", "alarm", ...
  void tell(double time_s, const std::string& kind, const std::string& text);

  /// {"tracks": [{"robot", "points": [[t, x, y, z], ...]}]}
  nlohmann::ordered_json tracks() const;
  /// {"bin_s", "classes": [..], "nodes": [{"node", "budget", "bins": [[t, bytes by class...], ...]}]}
  nlohmann::ordered_json traffic() const;
  /// {"events": [{"time_s", "kind", "text"}]}
  nlohmann::ordered_json events() const;

 private:
  struct Life {
    std::string phase, agreement;
    double heard_s = 0;
    int64_t conflicts = 0, rejected = 0;
    int64_t budget = 0;
    std::vector<TrackPoint> points;
    size_t stride = 1, skipped = 0;
    std::map<std::string, int64_t> sent;                     // last told, by class
    std::map<int64_t, std::map<std::string, int64_t>> bins;  // by time / bin
  };
  struct Event {
    double time_s;
    std::string kind, text;
  };

  static void follow(Life& life, const TrackPoint& point);
  void spread(Life& life, const std::string& traffic, int64_t bytes, double since_s, double until_s) const;
  void coarsen();

  std::map<std::string, Life> lives_;
  std::set<int64_t> labels_;
  std::vector<Event> events_;
  std::set<std::tuple<double, std::string, std::string>> heard_;  // of hearEvents(): time, kind, what it says
  double bin_s_ = 1;
};

}  // namespace shoal::console
