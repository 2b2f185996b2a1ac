// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace shoal::fusion_node {

/// Says, once until something is heard again, that nothing was heard for long: five seconds of wall time, or
/// on a budget below 1000 bytes/s as long as others' heartbeats may take with the like.
class SilenceAlarm {
 public:
  /// @param budget  bytes/s of mission time, 0 = unlimited. @param now_ms  wall time, any origin.
  SilenceAlarm(int64_t budget, int64_t now_ms);

  void heard(int64_t now_ms);

  /// What to warn of, when it is time to.
  std::optional<std::string> check(int64_t now_ms);

  double silentSeconds(int64_t now_ms) const { return static_cast<double>(now_ms - heard_ms_) * 1e-3; }

 private:
  int64_t patience_ms_, heard_ms_;
  bool warned_ = false, ever_ = false;
};

}  // namespace shoal::fusion_node
