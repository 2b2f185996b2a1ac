// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/event_log.h"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

#include "fusion_node/limits.h"

namespace shoal::fusion_node {
namespace {

constexpr size_t kMaxEvents = 5000;
constexpr size_t kMaxTold = 1000;
constexpr double kLostAfterS = 10;
constexpr double kHeartbeatBytes = 250;

// While content waits, heartbeats take at most a tenth of the budget.
double patience(const wire::Heartbeat& h) {
  return h.budget > 0 ? std::max(kLostAfterS, 4 * 10 * kHeartbeatBytes / h.budget) : kLostAfterS;
}

bool isPowerOfTen(uint64_t n) {
  while (n % 10 == 0 && n > 0) n /= 10;
  return n == 1;
}

}  // namespace

void EventLog::add(double at_s, std::string kind, std::string node, std::string says) {
  if (events_.size() >= kMaxEvents) events_.pop_front();
  events_.push_back({at_s, std::move(kind), std::move(node), std::move(says)});
}

void EventLog::restore(const std::vector<mapping::MissionEvent>& events) {
  const size_t most = std::min(events.size(), kMaxEvents);
  events_.assign(events.end() - static_cast<std::ptrdiff_t>(most), events.end());
  refusals_.clear();
  for (auto& [name, node] : nodes_) {
    node.wall_s = wall_s_;
    node.last.pid = 0;  // whoever speaks next under the name is it: we were not there
  }
}

void EventLog::passTime(double wall_s) {
  wall_s_ = std::max(wall_s_, wall_s);
  for (auto& [name, node] : nodes_) {
    if (node.lost || node.last.phase == wire::Phase::kLeaving) continue;
    if (wall_s_ - node.wall_s < patience(node.last)) continue;
    node.lost = true;
    add(latest_s_, "lost", name,
        fmt::format("not heard for {:.0f} s; last at {:.1f} s", wall_s_ - node.wall_s,
                    node.last.time.seconds()));
  }
}

void EventLog::heard(const std::string& name, const wire::Heartbeat& h) {
  const double at_s = h.time.seconds();
  latest_s_ = std::max(latest_s_, at_s);
  twins_.heard(name, h);
  const auto found = nodes_.find(name);
  if (found == nodes_.end()) {
    if (nodes_.size() >= kMaxNodes) return;
    nodes_.emplace(name, Node{h, wall_s_, false, false});
    add(at_s, "joined", name,
        h.budget > 0 ? fmt::format("first heard, {} bytes/s", h.budget) : "first heard, no budget");
    return;
  }
  Node& node = found->second;
  const bool is_newer = std::pair(h.epoch, h.time) > std::pair(node.last.epoch, node.last.time);
  if (node.lost) add(at_s, "back", name, fmt::format("heard again, after {:.0f} s", wall_s_ - node.wall_s));
  node.lost = false;
  node.wall_s = wall_s_;
  if (h.epoch > node.last.epoch) {
    add(at_s, "again", name, fmt::format("began anew, epoch {}: what it said before is void", h.epoch));
    node.twin = false;
  } else if (!node.twin && twins_.hasTwin(name)) {
    add(at_s, "twin", name, fmt::format("processes {} and {} speak as {}", node.last.pid, h.pid, name));
    node.twin = true;
  }
  if (!is_newer) return;
  if (h.phase != node.last.phase) {
    const bool has_landed = h.phase == wire::Phase::kListening || h.phase == wire::Phase::kLanded;
    if (has_landed && node.last.phase == wire::Phase::kFlying)
      add(at_s, "landed", name, fmt::format("after image {}", h.observation + 1));
    if (h.phase == wire::Phase::kLanded && node.last.phase == wire::Phase::kListening)
      add(at_s, "looked", name, "looked again at its map, with what all have learnt");
    if (h.phase == wire::Phase::kLeaving) add(at_s, "leaving", name, "ends in good order");
  }
  node.last = h;
}

void EventLog::refused(const std::string& channel, const comms::Stats& stats) {
  for (const auto& [reason, count] : stats.rejected) {
    uint64_t& seen = refusals_[std::string(reason)];
    const uint64_t more = count - seen;
    seen = count;
    if (more == 0 || (told_.size() >= kMaxTold && !told_.contains({channel, std::string(reason)}))) continue;
    uint64_t& told = told_[{channel, std::string(reason)}];
    for (uint64_t i = 0; i < more; ++i) {
      if (!isPowerOfTen(++told)) continue;
      add(latest_s_, "refused", channel, fmt::format("{} message{}: {}", told, told == 1 ? "" : "s", reason));
    }
  }
}

void EventLog::otherMission(int32_t mission) {
  add(latest_s_, "mission", "", fmt::format("mission {} is heard on the same URL", mission));
}

}  // namespace shoal::fusion_node
