// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/sender.h"

#include <algorithm>
#include <utility>

#include "shoal/demand.h"

namespace shoal::comms {

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
    const auto next = queue_.next(now_us);
    const bool content_first = heartbeat_went_last_ && next.has_value();
    if (heartbeat_.dueAt() <= now_us && !content_first) {
      const Packet packet = options_.make_heartbeat(now_us);
      if (const int64_t at_us = earliest(now_us, packet); at_us > now_us) return at_us;
      send(packet, TrafficClass::kHeartbeat, false, now_us);
      heartbeat_.sent(now_us, wireSize(packet));
      heartbeat_went_last_ = true;
      continue;
    }
    if (!next) return std::min(heartbeat_.dueAt(), queue_.nextResend().value_or(kNever));
    if (const int64_t at_us = earliest(now_us, *next->packet); at_us > now_us) {
      return content_first ? at_us : std::min(at_us, heartbeat_.dueAt());
    }
    Packet packet = *next->packet;
    if (options_.stamp) options_.stamp(packet, now_us);
    SHOAL_DEMAND(wireSize(packet) == wireSize(*next->packet));
    send(packet, next->traffic, next->resent, now_us);
    queue_.markSent(now_us);
    heartbeat_went_last_ = false;
  }
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
