// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/twin_watch.h"

namespace shoal::fusion_node {
namespace {

constexpr int kReturns = 3;
constexpr int64_t kOnItsWayUs = 60'000'000;

}  // namespace

void TwinWatch::heard(const std::string& node, const wire::Heartbeat& h) {
  if (!names_.contains(node) && names_.size() >= kMaxNames) return;
  Name& name = names_[node];
  const Process process{h.host, h.pid};
  const auto found = name.lives.find(process);
  if (found == name.lives.end()) {
    if (name.lives.size() >= kMaxProcesses) name.lives.erase(name.lives.begin());
    const auto before = name.lives.find(name.speaks);
    const int64_t before_us = before == name.lives.end() ? 0 : before->second.last_us;
    name.lives.emplace(process, Life{h.epoch, h.time.us, h.time.us, before_us, ++name.births});
    name.speaks = process;
    return;
  }
  Life& life = found->second;
  if (h.epoch < life.epoch || h.time.us <= life.last_us) return;  // late
  life.epoch = h.epoch;
  life.last_us = h.time.us;
  if (name.speaks == process) return;
  const auto other = name.lives.find(name.speaks);
  if (other != name.lives.end() && life.birth < other->second.birth && h.epoch >= other->second.epoch &&
      (h.time.us > other->second.first_us || h.time.us > other->second.before_us + kOnItsWayUs)) {
    ++name.returns;
  }
  name.speaks = process;
}

bool TwinWatch::hasTwin(const std::string& node) const {
  const auto name = names_.find(node);
  return name != names_.end() && name->second.returns >= kReturns;
}

}  // namespace shoal::fusion_node
