// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "shoal/comms/wall_time.h"

namespace shoal::comms {

struct WallPacerOptions {
  /// Wall time per datagram in the long run, >= 0. Receivers drain 16 senders without loss at 1 ms.
  int64_t gap_us = 1000;

  /// Datagrams that may follow each other without a gap, >= 1.
  int64_t burst = 8;
};

/// Spreads a train of datagrams in wall time, for the sake of the receivers' kernel buffers: no more than
/// `burst` + t / gap in any t. Apart from Budget, which is about the link, in mission time.
class WallPacer {
 public:
  /// @throws std::invalid_argument when an option is out of range.
  explicit WallPacer(const WallPacerOptions& options = {}, WallTime wall = realWallTime());

  /// Call before each datagram: sleeps when the burst is used up, until half of it is free again (few long
  /// sleeps are more exact than many short ones).
  void pace();

  /// Whether pace() would not sleep now. Who cannot wait asks, and comes back later.
  bool isFree() const;

 private:
  WallPacerOptions options_;
  WallTime wall_;
  int64_t paid_until_us_;  // the datagrams so far, one gap each, last until then
};

}  // namespace shoal::comms
