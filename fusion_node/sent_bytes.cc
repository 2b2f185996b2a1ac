// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/sent_bytes.h"

#include <algorithm>
#include <limits>

namespace shoal::fusion_node {
namespace {

void add(int64_t& sum, int64_t bytes) {
  sum += std::min(bytes, std::numeric_limits<int64_t>::max() - sum);  // anybody may claim anything
}

void add(SentBytes::Sum& sum, const SentBytes::Sum& more) {
  add(sum.bytes, more.bytes);
  for (size_t i = 0; i < sum.of_class.size(); ++i) add(sum.of_class[i], more.of_class[i]);
}

}  // namespace

void SentBytes::heard(const wire::Heartbeat& h) {
  const Process process{h.host, h.pid};
  const Age age{h.epoch, h.time.us};
  const auto found = lives_.find(process);
  if (found != lives_.end()) {
    const Life& life = found->second;
    const bool is_less = h.bytes_sent < life.sent.bytes;
    if (age < life.age || (age == life.age && is_less)) return;  // late
    if (is_less) add(ended_, life.sent);  // its number was given to another, as in a container
  } else if (lives_.size() >= kMaxProcesses) {
    const auto oldest =
        std::ranges::min_element(lives_, {}, [](const auto& life) { return life.second.heard; });
    add(ended_, oldest->second.sent);
    lives_.erase(oldest);
  }
  lives_[process] = {age, ++heard_, {h.bytes_sent, h.class_bytes}};
}

SentBytes::Sum SentBytes::sum() const {
  Sum sum = ended_;
  for (const auto& [process, life] : lives_) add(sum, life.sent);
  return sum;
}

}  // namespace shoal::fusion_node
