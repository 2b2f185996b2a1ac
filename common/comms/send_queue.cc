// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/send_queue.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "shoal/demand.h"

namespace shoal::comms {
namespace {

constexpr int64_t kStride = 1'000'000;

int64_t cost(const Packet& packet) { return static_cast<int64_t>(wireSize(packet)); }

}  // namespace

SendQueue::SendQueue(const SendQueueOptions& options)
    : min_resend_interval_us_(options.min_resend_interval_us) {
  of(TrafficClass::kMatches).weight = options.matches_weight;
  of(TrafficClass::kTopics).weight = options.topics_weight;
  of(TrafficClass::kBricks).weight = options.bricks_weight;
  of(TrafficClass::kCertainty).weight = options.certainty_weight;
  of(TrafficClass::kPictures).weight = options.pictures_weight;
  for (const auto traffic : {TrafficClass::kMatches, TrafficClass::kTopics, TrafficClass::kBricks,
                             TrafficClass::kCertainty, TrafficClass::kPictures}) {
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
    entry.packet = std::move(packet);
    return;
  }
  leave(found);
  entry.packet = std::move(packet);
  await(found);
}

void SendQueue::forget(std::string_view key) {
  const auto found = entries_.find(key);
  if (found == entries_.end()) return;
  leave(found);
  entries_.erase(found);
}

std::optional<SendQueue::Next> SendQueue::next(int64_t now_us) const {
  if (const Class* chosen = choose()) {
    const auto& [key, entry] = *chosen->waiting.begin()->second;
    return Next{entry.traffic, key, &entry.packet, false};
  }
  if (rotation_.empty() || *nextResend() > now_us) return std::nullopt;
  const auto& [key, entry] = *rotation_.begin()->second;
  return Next{entry.traffic, key, &entry.packet, true};
}

void SendQueue::markSent(int64_t now_us) {
  const Class* chosen = choose();
  SHOAL_DEMAND(chosen != nullptr || !rotation_.empty());
  const auto it = chosen != nullptr ? chosen->waiting.begin()->second : rotation_.begin()->second;
  Entry& entry = it->second;
  if (chosen != nullptr) {
    Class& served = of(entry.traffic);
    pass_ = served.pass;
    served.pass += cost(entry.packet) * (kStride / served.weight);
  }
  leave(it);
  entry.waiting = false;
  entry.place = next_place_++;
  entry.last_sent_us = now_us;
  rotation_.emplace(entry.place, it);
}

std::optional<int64_t> SendQueue::nextResend() const {
  if (rotation_.empty()) return std::nullopt;
  return rotation_.begin()->second->second.last_sent_us + min_resend_interval_us_;
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
}

}  // namespace shoal::comms
