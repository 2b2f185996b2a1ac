// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace shoal::fusion_node {

/// How far each robot's mission clock is ahead of the others', from the order in which heartbeats come: needs
/// no clock of its own, so that recordings tell the same.
///
/// When i is heard, j's clock shows at least what j said last: i is ahead of j by at most the difference. So
/// is j of i when j is heard. Between the two lies the truth, but for how long messages travel; what is said
/// here is the least that fits. A robot's skew is the median of what it is ahead of each other robot.
class ClockWatch {
 public:
  /// A heartbeat of a robot was heard. At most so many robots are followed; later ones are passed over.
  static constexpr size_t kMaxRobots = 300;
  void heard(const std::string& robot, int64_t time_us);

  /// Seconds of mission time that it is ahead of the others (behind: below 0). Nothing when it, or everybody
  /// else, was not heard. Cost: O(robots log robots).
  std::optional<double> skewOf(const std::string& robot) const;

 private:
  struct Clock {
    int64_t time_us = 0;                        // as it said last
    std::map<std::string, int64_t> at_most_us;  // ahead of each other, when it said that
  };
  std::map<std::string, Clock> clocks_;
};

}  // namespace shoal::fusion_node
