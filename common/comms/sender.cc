// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/sender.h"

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "shoal/demand.h"

namespace shoal::comms {
namespace {

constexpr size_t kMostJoined = 256;
constexpr int kTriesToJoin = 6;
constexpr double kStale = 0.125;      // part of what waits
constexpr size_t kBacklogTrials = 4;  // datagrams that are made to know what the others will take

}  // namespace

double contentPerSecond(int64_t bytes_per_s) {
  const auto fit = std::max<int64_t>(1, bytes_per_s / static_cast<int64_t>(kMaxWireBytes));
  const auto carried = static_cast<double>(fit) / static_cast<double>(fit + 1);
  return static_cast<double>(bytes_per_s) * (carried - HeartbeatPacer::kShareBesideContent);
}

Sender::Sender(Bus& link, Bus* local, SenderOptions options)
    : options_(std::move(options)),
      link_(link),
      local_(local),
      budget_(options_.bytes_per_s),
      queue_(options_.queue),
      heartbeat_(options_.bytes_per_s,
                 options_.make_heartbeat ? std::numeric_limits<int64_t>::min() : kNever),
      pacer_(options_.pacing, options_.wall) {}

int64_t Sender::pump(int64_t now_us) {
  while (true) {
    const Made* next = make(now_us);
    const bool content_first = heartbeat_went_last_ && next != nullptr;
    const int64_t heartbeat_due_us = heartbeat_.dueAt(next != nullptr);
    if (heartbeat_due_us <= now_us && !content_first) {
      Packet packet = options_.make_heartbeat(now_us);
      packet.trailer = link_.trailerBytes();
      if (const int64_t at_us = earliest(now_us, packet); at_us > now_us) return at_us;
      send(packet, TrafficClass::kHeartbeat, false, now_us);
      heartbeat_.sent(now_us, wireSize(packet));
      heartbeat_went_last_ = true;
      continue;
    }
    if (next == nullptr) return std::min(heartbeat_due_us, queue_.nextResend().value_or(kNever));
    if (const int64_t at_us = earliest(now_us, next->packet); at_us > now_us) {
      return content_first ? at_us : std::min(at_us, heartbeat_due_us);
    }
    Packet packet = next->packet;
    if (options_.stamp) options_.stamp(packet, now_us);
    SHOAL_DEMAND(wireSize(packet) == wireSize(next->packet));
    send(packet, next->traffic, next->resent, now_us);
    queue_.markSent(now_us, next->count, wireSize(packet));
    heartbeat_went_last_ = false;
  }
}

const Sender::Made* Sender::make(int64_t now_us) {
  if (made_ && made_->revision == queue_.revision()) return &*made_;
  made_.reset();
  const std::vector<SendQueue::Next> next = queue_.nextOf(now_us, options_.join ? kMostJoined : 1);
  if (next.empty()) return nullptr;
  size_t& last = joined_[static_cast<size_t>(next.front().traffic)];
  made_ = pack(next, last);
  last = made_->count;
  return &*made_;
}

// About as many as fit: how many is guessed from how many did last time, and mended a few times.
Sender::Made Sender::pack(std::span<const SendQueue::Next> next, size_t guess) const {
  Made made{queue_.revision(), *next.front().packet, 1, next.front().traffic, next.front().resent};
  if (!options_.join) return made;
  size_t too_many = next.size() + 1;
  size_t count = std::clamp<size_t>(guess, 2, std::max<size_t>(next.size(), 2));
  for (int tries = 0; tries < kTriesToJoin && made.count < count && count < too_many; ++tries) {
    auto joined = options_.join(next.first(count));
    const size_t bytes = joined ? std::max<size_t>(joined->bytes.size(), 1) : 2 * options_.most_joined_bytes;
    if (bytes > options_.most_joined_bytes) {
      too_many = count;
    } else {
      made.packet = std::move(*joined);
      made.packet.trailer = link_.trailerBytes();
      made.count = count;
      if (bytes * 8 > options_.most_joined_bytes * 7) break;  // full enough
    }
    const size_t proportional = count * options_.most_joined_bytes / bytes;
    count = std::clamp(proportional, made.count + 1, std::max(too_many - 1, made.count + 1));
  }
  return made;
}

int64_t Sender::backlog() const {
  if (!options_.join) return queue_.waitingBytes();
  std::optional<TrafficClass> stalest;
  double most_stale = kStale;
  for (size_t c = 0; c < kNumTrafficClasses; ++c) {
    const auto traffic = static_cast<TrafficClass>(c);
    const size_t waiting = queue_.numWaiting(traffic);
    if (waiting == 0) {
      trials_[c] = {};
      continue;
    }
    if (trials_[c].alone == 0) tryOut(traffic);
    const auto changes = static_cast<double>(queue_.changes(traffic) - trials_[c].changes);
    if (changes > most_stale * static_cast<double>(waiting)) {
      most_stale = changes / static_cast<double>(waiting);
      stalest = traffic;
    }
  }
  if (stalest) tryOut(*stalest);
  int64_t bytes = 0;
  for (size_t c = 0; c < kNumTrafficClasses; ++c) {
    const Trial& trial = trials_[c];
    if (trial.alone == 0) continue;
    const int64_t alone = queue_.waitingBytes(static_cast<TrafficClass>(c));
    bytes += std::max<int64_t>(1, (alone * trial.taken + trial.alone / 2) / trial.alone);
  }
  return bytes;
}

void Sender::tryOut(TrafficClass traffic) const {
  const auto c = static_cast<size_t>(traffic);
  Trial trial{queue_.changes(traffic), queue_.waitingBytes(traffic), 0};
  std::map<std::string_view, std::vector<SendQueue::Next>> by_channel;
  for (const SendQueue::Next& next : queue_.waiting(traffic))
    by_channel[next.packet->channel].push_back(next);
  for (const auto& [channel, waiting] : by_channel) trial.taken += backlogOf(waiting, joined_[c]);
  trials_[c] = trial;
}

// Of one class and channel.
int64_t Sender::backlogOf(std::span<const SendQueue::Next> waiting, size_t guess) const {
  const auto alone = [](std::span<const SendQueue::Next> some) {
    int64_t bytes = 0;
    for (const SendQueue::Next& each : some) bytes += static_cast<int64_t>(wireSize(*each.packet));
    return bytes;
  };
  // Of a packet of any size, cut into datagrams.
  const auto inDatagrams = [this](Packet packet) {
    packet.trailer = link_.trailerBytes();
    const auto bytes = static_cast<int64_t>(packet.bytes.size());
    const auto most = static_cast<int64_t>(options_.most_joined_bytes);
    const int64_t frame = static_cast<int64_t>(wireSize(packet)) - bytes;
    return bytes + std::max(frame, frame * bytes / most);
  };
  int64_t tried = 0;  // bytes of what was tried, each alone
  int64_t taken = 0;  // and in datagrams
  size_t end = 0;     // of the last trial
  bool has_gaps = false;
  const bool is_long = guess >= 2 && waiting.size() > 2 * kBacklogTrials * guess;
  for (size_t trial = 0; trial < kBacklogTrials && end < waiting.size(); ++trial) {
    const size_t begin = std::max(end, trial * waiting.size() / kBacklogTrials);
    const auto rest = waiting.subspan(begin);
    has_gaps = has_gaps || begin > end;
    if (has_gaps || is_long) {  // about as much as a datagram holds will do
      guess = std::max<size_t>(guess, 2);
      if (rest.size() < guess) break;  // not full: not like the others
      const auto some = rest.first(guess);
      const auto joined = options_.join(some);
      end = begin + some.size();
      tried += alone(some);
      taken += joined ? inDatagrams(*joined) : alone(some);
      if (joined) guess = guess * options_.most_joined_bytes / std::max<size_t>(joined->bytes.size(), 1);
      guess = std::min(guess, kMostJoined);
      continue;
    }
    const Made made = pack(rest.first(std::min(rest.size(), kMostJoined)), guess);
    end = begin + made.count;
    guess = made.count;
    tried += alone(rest.first(made.count));
    taken += static_cast<int64_t>(wireSize(made.packet));
  }
  if (!has_gaps && end == waiting.size()) return taken;
  return std::max<int64_t>(1, (alone(waiting) * taken + tried / 2) / tried);
}

void Sender::sendLocal(const Packet& packet) {
  if (local_ == nullptr) return;
  pacer_.pace();
  local_->publish(packet);
  stats_.countSent(TrafficClass::kLocal, wireSize(packet) + local_->trailerBytes(), false);
}

bool Sender::trySendLocal(const Packet& packet) {
  if (local_ != nullptr && !pacer_.isFree()) return false;
  sendLocal(packet);
  return true;
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
