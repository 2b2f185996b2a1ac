// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/clock_watch.h"

#include <algorithm>
#include <vector>

namespace shoal::fusion_node {

void ClockWatch::heard(const std::string& robot, int64_t time_us) {
  if (!clocks_.contains(robot) && clocks_.size() >= kMaxRobots) return;
  Clock& clock = clocks_[robot];
  clock.time_us = time_us;
  for (const auto& [other, its] : clocks_) {
    if (other != robot) clock.at_most_us[other] = time_us - its.time_us;
  }
}

std::optional<double> ClockWatch::skewOf(const std::string& robot) const {
  const auto clock = clocks_.find(robot);
  if (clock == clocks_.end()) return std::nullopt;
  std::vector<int64_t> ahead_us;
  for (const auto& [other, at_most_us] : clock->second.at_most_us) {
    const auto& others = clocks_.at(other).at_most_us;
    const auto back = others.find(robot);
    if (back == others.end()) continue;  // not heard since
    const int64_t at_least_us = -back->second;
    ahead_us.push_back(at_least_us <= at_most_us ? std::clamp<int64_t>(0, at_least_us, at_most_us)
                                                 : (at_least_us + at_most_us) / 2);
  }
  if (ahead_us.empty()) return std::nullopt;
  std::ranges::sort(ahead_us);
  const int64_t low = ahead_us[(ahead_us.size() - 1) / 2], high = ahead_us[ahead_us.size() / 2];
  return static_cast<double>(std::abs(low) <= std::abs(high) ? low : high) * 1e-6;
}

}  // namespace shoal::fusion_node
