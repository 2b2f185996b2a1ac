// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/send_queue.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "shoal/demand.h"

namespace shoal::comms {
namespace {

constexpr int64_t kStride = 1'000'000;

int64_t cost(const Packet& packet) { return static_cast<int64_t>(wireSize(packet)); }

}  // namespace

SendQueue::SendQueue(const SendQueueOptions& options)
    : min_resend_interval_us_(options.min_resend_interval_us), max_resends_(options.max_resends) {
  of(TrafficClass::kMatches).weight = options.matches_weight;
  of(TrafficClass::kTopics).weight = options.topics_weight;
  of(TrafficClass::kBricks).weight = options.bricks_weight;
  of(TrafficClass::kCertainty).weight = options.certainty_weight;
  of(TrafficClass::kPictures).weight = options.pictures_weight;
  of(TrafficClass::kRequests).weight = options.requests_weight;
  of(TrafficClass::kRepairs).weight = options.repairs_weight;
  for (const auto traffic :
       {TrafficClass::kMatches, TrafficClass::kTopics, TrafficClass::kBricks, TrafficClass::kCertainty,
        TrafficClass::kPictures, TrafficClass::kRequests, TrafficClass::kRepairs}) {
    const int64_t weight = of(traffic).weight;
    if (weight < 1 || weight > kStride) {
      throw std::invalid_argument("the weight of class " +
                                  std::string(kTrafficClassNames[static_cast<size_t>(traffic)]) +
                                  " must lie in 1 to 1000000, got " + std::to_string(weight));
    }
  }
  if (min_resend_interval_us_ < 1) {
    throw std::invalid_argument("min_resend_interval_us must be at least 1, got " +
                                std::to_string(min_resend_interval_us_));
  }
  if (max_resends_ < 0) {
    throw std::invalid_argument("max_resends must not be negative, got " + std::to_string(max_resends_));
  }
}

void SendQueue::offer(TrafficClass traffic, std::string_view key, Packet packet) {
  if (of(traffic).weight == 0) {
    throw std::invalid_argument("class " + std::string(kTrafficClassNames[static_cast<size_t>(traffic)]) +
                                " is not queued: heartbeats are made when due, local packets sent at once");
  }
  if (messageSize(packet) > kMaxMessageBytes) {
    throw std::invalid_argument("a message on " + packet.channel + " takes " +
                                std::to_string(messageSize(packet)) + " bytes, at most " +
                                std::to_string(kMaxMessageBytes) + " are allowed");
  }
  const auto found = entries_.find(key);
  if (found == entries_.end()) {
    await(entries_.emplace(key, Entry{traffic, std::move(packet), false, 0, 0}).first);
    return;
  }
  Entry& entry = found->second;
  if (entry.traffic != traffic) {
    throw std::invalid_argument(
        "a key of class " + std::string(kTrafficClassNames[static_cast<size_t>(entry.traffic)]) +
        " was offered again in class " + std::string(kTrafficClassNames[static_cast<size_t>(traffic)]));
  }
  if (entry.packet.channel == packet.channel && entry.packet.bytes == packet.bytes) return;
  if (entry.waiting) {
    of(traffic).waiting_bytes += cost(packet) - cost(entry.packet);
    ++of(traffic).changes;
    entry.packet = std::move(packet);
    ++revision_;
    return;
  }
  leave(found);
  entry.packet = std::move(packet);
  entry.num_sent = 0;
  await(found);
}

void SendQueue::forget(std::string_view key) {
  const auto found = entries_.find(key);
  if (found == entries_.end()) return;
  leave(found);
  entries_.erase(found);
  ++revision_;
}

std::optional<SendQueue::Next> SendQueue::next(int64_t now_us) const {
  const std::vector<Next> first = nextOf(now_us, 1);
  if (first.empty()) return std::nullopt;
  return first.front();
}

std::vector<SendQueue::Next> SendQueue::nextOf(int64_t now_us, size_t most) const {
  std::vector<Next> all;
  for (const auto& it : chosen(now_us, most))
    all.push_back({it->second.traffic, it->first, &it->second.packet, !it->second.waiting});
  return all;
}

std::vector<SendQueue::Next> SendQueue::waiting(TrafficClass traffic) const {
  std::vector<Next> all;
  for (const auto& [place, it] : of(traffic).waiting)
    all.push_back({traffic, it->first, &it->second.packet, false});
  return all;
}

// New content when there is any, else what is due to be said again.
std::vector<SendQueue::Entries::const_iterator> SendQueue::chosen(int64_t now_us, size_t most) const {
  std::vector<Entries::const_iterator> all;
  const Class* waiting = choose();
  for (const auto& [place, it] : waiting != nullptr ? waiting->waiting : rotation_) {
    if (all.size() == most) break;
    const Entry& entry = it->second;
    if (waiting == nullptr && entry.last_sent_us + min_resend_interval_us_ > now_us) break;
    const bool follows = all.empty() || (entry.traffic == all.front()->second.traffic &&
                                         entry.packet.channel == all.front()->second.packet.channel);
    if (follows) all.push_back(it);
  }
  return all;
}

void SendQueue::markSent(int64_t now_us, size_t count, size_t wire_bytes) {
  const bool is_new = choose() != nullptr;
  // Whatever the time: who marks has been told what was due.
  const auto sent = chosen(is_new ? now_us : std::numeric_limits<int64_t>::max(), count);
  SHOAL_DEMAND(count > 0 && sent.size() == count);
  if (is_new) {
    const Entry& first = sent.front()->second;
    Class& served = of(first.traffic);
    pass_ = served.pass;
    const int64_t bytes = wire_bytes > 0 ? static_cast<int64_t>(wire_bytes) : cost(first.packet);
    served.pass += bytes * (kStride / served.weight);
  }
  for (const auto& each : sent) {
    const auto it = entries_.find(each->first);
    Entry& entry = it->second;
    leave(it);
    if (entry.traffic == TrafficClass::kRequests || entry.traffic == TrafficClass::kRepairs) {
      entries_.erase(it);
      continue;
    }
    entry.waiting = false;
    entry.place = next_place_++;
    if (entry.num_sent++ >= max_resends_) continue;  // held all the same: equal bytes are no news
    entry.last_sent_us = now_us;
    rotation_.emplace(entry.place, it);
  }
  ++revision_;
}

std::optional<int64_t> SendQueue::nextResend() const {
  if (rotation_.empty()) return std::nullopt;
  return rotation_.begin()->second->second.last_sent_us + min_resend_interval_us_;
}

bool SendQueue::isWaiting(std::string_view key) const {
  const auto found = entries_.find(key);
  return found != entries_.end() && found->second.waiting;
}

const Packet* SendQueue::held(std::string_view key) const {
  const auto found = entries_.find(key);
  return found == entries_.end() ? nullptr : &found->second.packet;
}

int64_t SendQueue::waitingBytes() const {
  int64_t bytes = 0;
  for (const Class& each : classes_) bytes += each.waiting_bytes;
  return bytes;
}

const SendQueue::Class* SendQueue::choose() const {
  const Class* chosen = nullptr;
  for (const Class& each : classes_) {
    if (!each.waiting.empty() && (chosen == nullptr || each.pass < chosen->pass)) chosen = &each;
  }
  return chosen;
}

void SendQueue::await(Entries::iterator it) {
  ++revision_;
  Entry& entry = it->second;
  Class& joined = of(entry.traffic);
  if (choose() == nullptr) {  // nobody is owed anything: utility decides afresh
    for (const Class& each : classes_) pass_ = std::max(pass_, each.pass);
  }
  if (joined.waiting.empty()) joined.pass = std::max(joined.pass, pass_);
  entry.waiting = true;
  entry.place = next_place_++;
  joined.waiting.emplace(entry.place, it);
  joined.waiting_bytes += cost(entry.packet);
  ++joined.changes;
}

void SendQueue::leave(Entries::iterator it) {
  const Entry& entry = it->second;
  if (!entry.waiting) {
    rotation_.erase(entry.place);
    return;
  }
  Class& left = of(entry.traffic);
  left.waiting.erase(entry.place);
  left.waiting_bytes -= cost(entry.packet);
  ++left.changes;
}

}  // namespace shoal::comms
