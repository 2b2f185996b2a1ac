// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace shoal::comms {

/// A closed window of mission time and what was sent in it.
struct MeteredWindow {
  int64_t start_us = 0;
  int64_t length_us = 0;  ///< >= 1 s, 0 when nothing was sent.
  int64_t bytes = 0;
  size_t datagrams = 0;
  double share = 0;           ///< bytes / allowed bytes; above 1 is over budget. 0 when unlimited.
  bool within_budget = true;  ///< Decided in integers, not by `share`.
};

/// Checks a budget after the fact, from times and sizes alone: an implementation apart from Budget, for tests
/// and for logs. Finds the worst of all windows of T >= 1 s exactly.
class WindowMeter {
 public:
  /// @param bytes_per_s  0 = unlimited.
  /// @throws std::invalid_argument when negative.
  explicit WindowMeter(int64_t bytes_per_s);

  /// A datagram, in any order of time.
  void add(int64_t at_us, size_t bytes);

  /// The window with the largest bytes / max(bytes_per_s x T, the datagram when it stands alone); of equal
  /// ones the earliest to end. Cost: O(n log n).
  MeteredWindow worst() const;

  /// The same of several stretches of time, in one go: of the windows that end in [from_us[k], from_us[k +
  /// 1]), the last without an end, wherever they begin. @param from_us  ascending.
  std::vector<MeteredWindow> worstEndingIn(const std::vector<int64_t>& from_us) const;

 private:
  struct Sent {
    int64_t at_us;
    int64_t bytes;
  };

  int64_t bytes_per_s_;
  std::vector<Sent> sent_;
};

}  // namespace shoal::comms
