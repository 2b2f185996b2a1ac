// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "shoal/comms/bus.h"

namespace shoal::comms {

/// How bad the network is. Probabilities in [0, 1], drawn for each packet and receiver from the seed alone.
struct MemoryNetworkOptions {
  uint64_t seed = 0;
  double loss = 0;
  double duplication = 0;
  double reordering = 0;  ///< A packet overtakes up to 8 that wait before it.
};

class MemoryBus;

/// A multicast group in one process, for tests: everybody hears everybody and, without fail, itself. Not for
/// several threads. Outlives its buses.
class MemoryNetwork {
 public:
  /// @throws std::invalid_argument when a probability is not in [0, 1].
  explicit MemoryNetwork(const MemoryNetworkOptions& options = {});

  /// Joins. Buses are numbered 0, 1, ... in this order.
  std::unique_ptr<MemoryBus> connect();

  /// From now on only buses of the same group hear each other; group[i] is bus i's.
  /// @throws std::invalid_argument unless there is one group for each bus.
  void partition(std::vector<int> group);

  /// Ends a partition.
  void heal() { group_.clear(); }

 private:
  friend class MemoryBus;
  void publish(size_t from, const Packet& packet);

  MemoryNetworkOptions options_;
  std::vector<std::deque<Packet>> inboxes_;
  std::vector<int> group_;  // empty: no partition
  uint64_t num_published_ = 0;
};

class MemoryBus final : public Bus {
 public:
  void publish(const Packet& packet) override { network_.publish(index_, packet); }

  /// Delivers what had arrived at the call; never waits. What `handler` publishes comes with the next call.
  int receive(int timeout_ms, const std::function<void(const Packet&)>& handler) override;

 private:
  friend class MemoryNetwork;
  MemoryBus(MemoryNetwork& network, size_t index) : network_(network), index_(index) {}

  MemoryNetwork& network_;
  size_t index_;
};

}  // namespace shoal::comms
