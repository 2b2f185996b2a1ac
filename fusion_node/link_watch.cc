// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/link_watch.h"

#include <algorithm>

namespace shoal::fusion_node {
namespace {

constexpr int64_t kSpanUs = 60'000'000;

}  // namespace

void LinkWatch::heard(const std::string& node, size_t bytes) {
  const auto found = nodes_.find(node);
  if (found != nodes_.end()) found->second.heard += static_cast<int64_t>(bytes);
}

void LinkWatch::claimed(const std::string& name, const wire::Heartbeat& h) {
  if (!nodes_.contains(name) && nodes_.size() >= kMaxNames) return;
  Node& node = nodes_[name];
  if (node.pid != h.pid) node = {};  // another process counts from nothing
  node.pid = h.pid;
  if (!node.beats.empty() &&
      (h.time.us <= node.beats.back().time_us || h.bytes_sent < node.beats.back().sent))
    return;  // late
  node.beats.push_back({h.time.us, h.bytes_sent, node.heard});
  while (node.beats.size() > kMaxBeats ||
         (node.beats.size() > 3 && node.beats.front().time_us < h.time.us - kSpanUs)) {
    node.beats.pop_front();
  }
}

std::optional<double> LinkWatch::shareOf(const std::string& name) const {
  const auto node = nodes_.find(name);
  if (node == nodes_.end() || node->second.beats.size() < 3) return {};
  const Beat& first = node->second.beats.front();
  const Beat& last = node->second.beats.back();
  if (last.sent <= first.sent) return {};
  const double share =
      static_cast<double>(last.heard - first.heard) / static_cast<double>(last.sent - first.sent);
  return std::clamp(share, 0.0, 1.0);  // what comes twice, or late, may add up to more
}

std::optional<int64_t> LinkWatch::missedOf(const std::string& name) const {
  const auto node = nodes_.find(name);
  if (node == nodes_.end() || node->second.beats.empty()) return {};
  const Beat& last = node->second.beats.back();
  return last.sent - last.heard;
}

}  // namespace shoal::fusion_node
