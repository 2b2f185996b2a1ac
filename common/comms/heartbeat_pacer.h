// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace shoal::comms {

/// Heartbeats take at most a fifth of the budget, and a tenth while content waits: what budgets allow of
/// large datagrams is little more than half of a thin one (Budget). The next is due max(1 s, 5 or 10 x wire
/// size / budget) after the last.
class HeartbeatPacer {
 public:
  static constexpr int64_t kIntervalUs = 1'000'000;
  static constexpr double kShareBesideContent = 0.1;  ///< of the budget, at most

  /// @param bytes_per_s  The whole budget, 0 = unlimited. The first heartbeat is due at once.
  HeartbeatPacer(int64_t bytes_per_s, int64_t first_due_us)
      : bytes_per_s_(bytes_per_s), due_us_(first_due_us), due_beside_content_us_(first_due_us) {}

  int64_t dueAt(bool content_waits) const { return content_waits ? due_beside_content_us_ : due_us_; }

  /// The next is due by then.
  void hurry(int64_t due_us) {
    due_us_ = std::min(due_us_, due_us);
    due_beside_content_us_ = std::min(due_beside_content_us_, due_us);
  }

  /// A heartbeat of `wire_bytes` went out.
  void sent(int64_t at_us, size_t wire_bytes) {
    due_us_ = at_us + interval(5, wire_bytes);
    due_beside_content_us_ = at_us + interval(10, wire_bytes);
  }

 private:
  // One that takes 1 / part of the budget.
  int64_t interval(int64_t part, size_t wire_bytes) const {
    if (bytes_per_s_ == 0) return kIntervalUs;
    const int64_t scaled = part * kIntervalUs * static_cast<int64_t>(wire_bytes);
    return std::max(kIntervalUs, (scaled + bytes_per_s_ - 1) / bytes_per_s_);
  }

  int64_t bytes_per_s_;
  int64_t due_us_;                 // when nothing else waits
  int64_t due_beside_content_us_;  // never sooner
};

}  // namespace shoal::comms
