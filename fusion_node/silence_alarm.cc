// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/silence_alarm.h"

#include <algorithm>

namespace shoal::fusion_node {

SilenceAlarm::SilenceAlarm(int64_t budget, int64_t now_ms)
    : patience_ms_(budget > 0 ? std::max<int64_t>(5000, 5'000'000 / budget) : 5000), heard_ms_(now_ms) {}

void SilenceAlarm::heard(int64_t now_ms) {
  heard_ms_ = now_ms;
  warned_ = false;
  ever_ = true;
}

std::optional<std::string> SilenceAlarm::check(int64_t now_ms) {
  if (warned_ || now_ms - heard_ms_ < patience_ms_) return std::nullopt;
  warned_ = true;
  const std::string seconds = std::to_string((now_ms - heard_ms_) / 1000);
  return ever_ ? "nobody else was heard for " + seconds + " s"
               : "nobody else was heard for " + seconds +
                     " s: do all have the same --lcm-url and --mission? operator_console doctor looks at the "
                     "network";
}

}  // namespace shoal::fusion_node
