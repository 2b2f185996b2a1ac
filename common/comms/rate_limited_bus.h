// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "shoal/comms/bus.h"
#include "shoal/comms/wall_time.h"

namespace shoal::comms {

struct RateLimits {
  /// Messages that one node may say in a second of wall time in the long run, > 0. WallPacer lets our own
  /// senders say 1000.
  double per_s = 2000;
  /// And at once, >= 1: a receiver that was held up finds several seconds' worth waiting.
  double burst = 8192;
  /// Nodes not heard lately whose first message is taken, a second and at once: who floods under ever new
  /// names is slowed down, those who are known already are not.
  double new_nodes_per_s = 100;
  double new_nodes_burst = 1024;

  WallTime wall = realWallTime();
};

/// A bus on which nobody can be so loud that others are not heard: what a node, by the name of its channel,
/// says above a rate is dropped before it is decoded. Put it on top of AuthenticatedBus, if there is one, so
/// that who has no key cannot use up the share of a name. Memory is bounded: kMaxNodes names, the one heard
/// least recently is forgotten.
class RateLimitedBus final : public Bus {
 public:
  static constexpr size_t kMaxNodes = 4096;

  /// `air` outlives it.
  /// @throws std::invalid_argument when a limit is out of range.
  explicit RateLimitedBus(Bus& air, const RateLimits& limits = {});

  void publish(const Packet& packet) override { air_.publish(packet); }

  /// Returns the number delivered, which may be 0 although something was heard.
  int receive(int timeout_ms, const std::function<void(const Packet&)>& handler) override;

  size_t trailerBytes() const override { return air_.trailerBytes(); }

  void countInto(Stats& stats) override;

  uint64_t numDropped() const { return num_dropped_; }

 private:
  // Fills at a rate up to a burst; a message takes 1.
  struct Bucket {
    double level = 0;
    int64_t at_us = 0;
  };
  static bool take(Bucket& bucket, double per_s, double burst, int64_t now_us);
  bool admit(const std::string& channel);
  void forgetOldest();

  Bus& air_;
  RateLimits limits_;
  std::map<std::string, Bucket> nodes_;
  Bucket new_nodes_;
  uint64_t num_dropped_ = 0;
  Stats* stats_ = nullptr;
};

}  // namespace shoal::comms
