// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/rate_limited_bus.h"

#include <algorithm>
#include <stdexcept>

#include "shoal/comms/channels.h"
#include "shoal/comms/stats.h"

namespace shoal::comms {

RateLimitedBus::RateLimitedBus(Bus& air, const RateLimits& limits) : air_(air), limits_(limits) {
  const auto demand = [](bool good, const char* what) {
    if (!good) throw std::invalid_argument(what);
  };
  demand(limits.per_s > 0 && limits.new_nodes_per_s > 0, "rates of messages must be above 0");
  demand(limits.burst >= 1 && limits.new_nodes_burst >= 1, "bursts of messages must be at least 1");
  new_nodes_ = {limits.new_nodes_burst, limits_.wall.now_us()};
}

int RateLimitedBus::receive(int timeout_ms, const std::function<void(const Packet&)>& handler) {
  int delivered = 0;
  air_.receive(timeout_ms, [&](const Packet& packet) {
    if (!admit(packet.channel)) {
      ++num_dropped_;
      if (stats_ != nullptr) stats_->countRejected("too fast");
      return;
    }
    ++delivered;
    handler(packet);
  });
  return delivered;
}

void RateLimitedBus::countInto(Stats& stats) {
  stats_ = &stats;
  air_.countInto(stats);
}

bool RateLimitedBus::take(Bucket& bucket, double per_s, double burst, int64_t now_us) {
  const double waited_s = static_cast<double>(std::max<int64_t>(now_us - bucket.at_us, 0)) * 1e-6;
  bucket.level = std::min(bucket.level + waited_s * per_s, burst);
  bucket.at_us = std::max(bucket.at_us, now_us);
  if (bucket.level < 1) return false;
  bucket.level -= 1;
  return true;
}

bool RateLimitedBus::admit(const std::string& channel) {
  const auto name = parseChannel(channel);
  if (!name) return true;  // for others to refuse
  const int64_t now_us = limits_.wall.now_us();
  auto node = nodes_.find(name->node);
  if (node == nodes_.end()) {
    if (!take(new_nodes_, limits_.new_nodes_per_s, limits_.new_nodes_burst, now_us)) return false;
    if (nodes_.size() >= kMaxNodes) forgetOldest();
    node = nodes_.emplace(name->node, Bucket{limits_.burst, now_us}).first;
  }
  return take(node->second, limits_.per_s, limits_.burst, now_us);
}

void RateLimitedBus::forgetOldest() {
  nodes_.erase(std::ranges::min_element(nodes_, {}, [](const auto& node) { return node.second.at_us; }));
}

}  // namespace shoal::comms
