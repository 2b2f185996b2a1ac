// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/memory_bus.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "shoal/random.h"

namespace shoal::comms {
namespace {

constexpr size_t kLongestOvertaking = 8;

void checkProbability(const char* name, double p) {
  if (p >= 0 && p <= 1) return;
  throw std::invalid_argument(std::string(name) + " must lie in [0, 1], got " + std::to_string(p));
}

}  // namespace

MemoryNetwork::MemoryNetwork(const MemoryNetworkOptions& options) : options_(options) {
  checkProbability("loss", options.loss);
  checkProbability("duplication", options.duplication);
  checkProbability("reordering", options.reordering);
}

std::unique_ptr<MemoryBus> MemoryNetwork::connect() {
  inboxes_.emplace_back();
  group_.clear();
  return std::unique_ptr<MemoryBus>(new MemoryBus(*this, inboxes_.size() - 1));
}

void MemoryNetwork::partition(std::vector<int> group) {
  if (group.size() != inboxes_.size()) {
    throw std::invalid_argument("a partition of " + std::to_string(inboxes_.size()) +
                                " buses needs as many groups, got " + std::to_string(group.size()));
  }
  group_ = std::move(group);
}

void MemoryNetwork::publish(size_t from, const Packet& packet) {
  const uint64_t number = num_published_++;
  for (size_t to = 0; to < inboxes_.size(); ++to) {
    std::deque<Packet>& inbox = inboxes_[to];
    if (to == from) {
      inbox.push_back(packet);
      continue;
    }
    if (!group_.empty() && group_[to] != group_[from]) continue;
    Random random(options_.seed, number, to);
    if (random.uniform() < options_.loss) continue;
    const int copies = random.uniform() < options_.duplication ? 2 : 1;
    for (int copy = 0; copy < copies; ++copy) {
      size_t overtaken = 0;
      if (random.uniform() < options_.reordering) {
        overtaken = static_cast<size_t>(random.below(std::min(inbox.size(), kLongestOvertaking) + 1));
      }
      inbox.insert(inbox.end() - static_cast<std::ptrdiff_t>(overtaken), packet);
    }
  }
}

int MemoryBus::receive(int /*timeout_ms*/, const std::function<void(const Packet&)>& handler) {
  const std::deque<Packet> arrived = std::exchange(network_.inboxes_[index_], {});
  for (const Packet& packet : arrived) handler(packet);
  return static_cast<int>(arrived.size());
}

}  // namespace shoal::comms
