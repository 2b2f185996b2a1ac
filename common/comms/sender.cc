// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/sender.h"

#include <algorithm>
#include <utility>

#include "shoal/demand.h"

namespace shoal::comms {
namespace {

constexpr size_t kMostJoined = 256;
constexpr int kTriesToJoin = 6;

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
      Packet packet = options_.make_heartbeat(now_us);
      packet.trailer = link_.trailerBytes();
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

// About as many as fit: how many is guessed from how many did last time, and mended a few times.
const Sender::Made* Sender::make(int64_t now_us) {
  if (made_ && made_->revision == queue_.revision()) return &*made_;
  made_.reset();
  const std::vector<SendQueue::Next> next = queue_.nextOf(now_us, options_.join ? kMostJoined : 1);
  if (next.empty()) return nullptr;
  const auto traffic = next.front().traffic;
  made_ = Made{queue_.revision(), *next.front().packet, 1, traffic, next.front().resent};
  size_t& last = joined_[static_cast<size_t>(traffic)];
  size_t too_many = next.size() + 1;
  size_t count = std::clamp<size_t>(last, 2, next.size());
  for (int tries = 0; tries < kTriesToJoin && made_->count < count && count < too_many; ++tries) {
    auto joined = options_.join(std::span(next).first(count));
    const size_t bytes = joined ? std::max<size_t>(joined->bytes.size(), 1) : 2 * options_.most_joined_bytes;
    if (bytes > options_.most_joined_bytes) {
      too_many = count;
    } else {
      made_->packet = std::move(*joined);
      made_->packet.trailer = link_.trailerBytes();
      made_->count = count;
      if (bytes * 8 > options_.most_joined_bytes * 7) break;  // full enough
    }
    const size_t proportional = count * options_.most_joined_bytes / bytes;
    count = std::clamp(proportional, made_->count + 1, std::max(too_many - 1, made_->count + 1));
  }
  last = made_->count;
  return &*made_;
}

void Sender::sendLocal(const Packet& packet) {
  if (local_ == nullptr) return;
  pacer_.pace();
  local_->publish(packet);
  stats_.countSent(TrafficClass::kLocal, wireSize(packet) + local_->trailerBytes(), false);
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
