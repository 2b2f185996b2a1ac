// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/sender.h"

#include <algorithm>
#include <utility>

#include "shoal/demand.h"

namespace shoal::comms {
namespace {

constexpr size_t kMostJoined = 256;

}  // namespace

Sender::Sender(Bus& link, Bus* local, SenderOptions options)
    : options_(std::move(options)),
      link_(link),
      local_(local),
      budget_(options_.bytes_per_s),
      queue_(options_.queue),
      heartbeat_(options_.bytes_per_s,
                 options_.make_heartbeat ? std::numeric_limits<int64_t>::min() : kNever),
      pacer_(options_.pacing, options_.wall) {
  if (options_.resumed_at_us) budget_.assumeExhausted(*options_.resumed_at_us, kMaxWireBytes);
}

int64_t Sender::pump(int64_t now_us) {
  while (true) {
    const Made* next = make(now_us);
    const bool content_first = heartbeat_went_last_ && next != nullptr;
    if (heartbeat_.dueAt() <= now_us && !content_first) {
      const Packet packet = options_.make_heartbeat(now_us);
      if (const int64_t at_us = earliest(now_us, packet); at_us > now_us) return at_us;
      send(packet, TrafficClass::kHeartbeat, false, now_us);
      heartbeat_.sent(now_us, wireSize(packet));
      heartbeat_went_last_ = true;
      continue;
    }
    if (next == nullptr) return std::min(heartbeat_.dueAt(), queue_.nextResend().value_or(kNever));
    if (const int64_t at_us = earliest(now_us, next->packet); at_us > now_us) {
      return content_first ? at_us : std::min(at_us, heartbeat_.dueAt());
    }
    Packet packet = next->packet;
    if (options_.stamp) options_.stamp(packet, now_us);
    SHOAL_DEMAND(wireSize(packet) == wireSize(next->packet));
    send(packet, next->traffic, next->resent, now_us);
    queue_.markSent(now_us, next->count, wireSize(packet));
    heartbeat_went_last_ = false;
  }
}

// As many as fit: from as many as fitted last time up or down in doubling steps, then by bisection.
const Sender::Made* Sender::make(int64_t now_us) {
  if (made_ && made_->revision == queue_.revision()) return &*made_;
  made_.reset();
  const std::vector<SendQueue::Next> next = queue_.nextOf(now_us, options_.join ? kMostJoined : 1);
  if (next.empty()) return nullptr;
  const auto traffic = next.front().traffic;
  made_ = Made{queue_.revision(), *next.front().packet, 1, traffic, next.front().resent};
  if (next.size() == 1) return &*made_;
  std::vector<const Packet*> packets;
  for (const SendQueue::Next& each : next) packets.push_back(each.packet);
  const auto join = [&](size_t count) {
    auto joined = options_.join(std::span(packets).first(count));
    if (!joined) return false;
    made_->packet = std::move(*joined);
    made_->count = count;
    return true;
  };
  size_t& last = joined_[static_cast<size_t>(traffic)];
  size_t bad = packets.size() + 1;
  for (size_t count = std::clamp<size_t>(last, 2, packets.size()); made_->count < count;) {
    if (!join(count)) {
      bad = count;
      break;
    }
    count = std::min(2 * count, packets.size());
  }
  while (bad - made_->count > 1) {
    const size_t middle = made_->count + (bad - made_->count) / 2;
    if (!join(middle)) bad = middle;
  }
  last = made_->count;
  return &*made_;
}

void Sender::sendLocal(const Packet& packet) {
  if (local_ == nullptr) return;
  pacer_.pace();
  local_->publish(packet);
  stats_.countSent(TrafficClass::kLocal, wireSize(packet), false);
}

int64_t Sender::earliest(int64_t now_us, const Packet& packet) const {
  return budget_.earliest(now_us, wireSize(packet));
}

void Sender::send(const Packet& packet, TrafficClass traffic, bool resent, int64_t now_us) {
  budget_.spend(now_us, wireSize(packet));
  pacer_.pace();
  link_.publish(packet);
  stats_.countSent(traffic, wireSize(packet), resent);
}

}  // namespace shoal::comms
