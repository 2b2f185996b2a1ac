// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace shoal::comms {

/// Heartbeats take at most a fifth of the budget: the next is due max(1 s, 5 x wire size / budget) after the
/// last.
class HeartbeatPacer {
 public:
  static constexpr int64_t kIntervalUs = 1'000'000;

  /// @param bytes_per_s  The whole budget, 0 = unlimited. The first heartbeat is due at once.
  HeartbeatPacer(int64_t bytes_per_s, int64_t first_due_us)
      : bytes_per_s_(bytes_per_s), due_us_(first_due_us) {}

  int64_t dueAt() const { return due_us_; }

  /// The next is due by then.
  void hurry(int64_t due_us) { due_us_ = std::min(due_us_, due_us); }

  /// A heartbeat of `wire_bytes` went out.
  void sent(int64_t at_us, size_t wire_bytes) {
    int64_t interval_us = kIntervalUs;
    if (bytes_per_s_ > 0) {
      const int64_t scaled = 5 * kIntervalUs * static_cast<int64_t>(wire_bytes);
      interval_us = std::max(interval_us, (scaled + bytes_per_s_ - 1) / bytes_per_s_);
    }
    due_us_ = at_us + interval_us;
  }

 private:
  int64_t bytes_per_s_;
  int64_t due_us_;
};

}  // namespace shoal::comms
