// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string_view>

#include "shoal/comms/budget.h"
#include "shoal/comms/bus.h"
#include "shoal/comms/heartbeat_pacer.h"
#include "shoal/comms/packet.h"
#include "shoal/comms/send_queue.h"
#include "shoal/comms/stats.h"
#include "shoal/comms/wall_pacer.h"

namespace shoal::comms {

struct SenderOptions {
  /// Bytes on the wire per second of mission time, 0 = unlimited.
  int64_t bytes_per_s = 0;

  SendQueueOptions queue = {};
  WallPacerOptions pacing = {};
  WallTime wall = realWallTime();

  /// Makes a heartbeat at the moment of sending. Called again, at a later time, when the budget made it wait.
  /// None when empty.
  std::function<Packet(int64_t now_us)> make_heartbeat = {};

  /// Writes the time of sending into a copy of an offered packet, which must keep its size. None when empty.
  std::function<void(Packet& packet, int64_t now_us)> stamp = {};

  /// Makes one packet, of any size, of several that were offered, all of one class and channel; nothing when
  /// they cannot share a datagram. Then more is said with fewer headers. None when empty.
  std::function<std::optional<Packet>(std::span<const SendQueue::Next> together)> join = {};
  size_t most_joined_bytes = 0;  ///< of a message that join() made; longer ones are not sent
};

/// Bytes of content on the wire that a budget surely lets say in a second of mission time, beside heartbeats:
/// what windows carry of full datagrams (Budget), less the tenth that heartbeats take. 0 = unlimited.
double contentPerSecond(int64_t bytes_per_s);

/// The single choke point: everything a node sends passes here, is counted, and on the link kept in budget.
/// Order: a heartbeat when due, then SendQueue's. Who is first waits for the budget and nothing smaller
/// overtakes. While content waits, no heartbeat follows another: on a thin link, a large datagram would never
/// find room between them.
class Sender {
 public:
  static constexpr int64_t kNever = std::numeric_limits<int64_t>::max();

  /// Both buses outlive the sender. Without a `local` bus, sendLocal() sends nothing.
  /// @throws std::invalid_argument when an option is out of range.
  Sender(Bus& link, Bus* local, SenderOptions options);

  /// As SendQueue.
  void offer(TrafficClass traffic, std::string_view key, Packet packet) {
    packet.trailer = link_.trailerBytes();
    queue_.offer(traffic, key, std::move(packet));
  }
  void forget(std::string_view key) { queue_.forget(key); }

  /// The process came back, and the one before it may have used all of the budget up to this mission time:
  /// nothing goes out before the worst of that is a matter of the past.
  void assumeExhausted(int64_t at_us) { budget_.assumeExhausted(at_us, kMaxWireBytes); }

  /// Sends all that may go out at mission time now_us, and returns the mission time, > now_us, at which more
  /// could, or kNever. A budget in use is only used up when pump() is called again at that very time: callers
  /// who pump once a second get little more than half of it. May sleep, to pace in wall time.
  int64_t pump(int64_t now_us);

  /// Makes the next heartbeat due now: it goes as soon as the budget lets it.
  void hurryHeartbeat(int64_t now_us) { heartbeat_.hurry(now_us); }

  /// Sends at once on the local bus: class local, paced in wall time, outside the budget.
  void sendLocal(const Packet& packet);

  /// The same if it need not sleep for that; else false, and nothing is sent.
  bool trySendLocal(const Packet& packet);

  /// Bytes on the wire that it will take to say all that waits, with pieces sharing datagrams as they will:
  /// exact while a class takes few datagrams, else from a few that are made of what waits for a trial, evenly
  /// spread. A class is tried again when an eighth of what waits in it is other than it was, but one a call;
  /// until then as much is taken to share a datagram as at the last trial. 0 only when nothing waits.
  /// Cost: some datagrams made of one class, at the first call of each.
  int64_t backlog() const;

  /// For the caller to count what it refused from others.
  Stats& stats() { return stats_; }
  const Stats& stats() const { return stats_; }
  const SendQueue& queue() const { return queue_; }
  WorstWindow worstWindow() const { return budget_.worst(); }

 private:
  // A datagram made of the first `count` that are next, as long as the queue stays as it is.
  struct Made {
    uint64_t revision = 0;
    Packet packet;
    size_t count = 0;
    TrafficClass traffic{};
    bool resent = false;
  };

  // How much smaller a class is in datagrams than alone.
  struct Trial {
    uint64_t changes = 0;  // of the class, by then
    int64_t alone = 0;     // bytes; 0: not tried
    int64_t taken = 0;
  };

  const Made* make(int64_t now_us);
  void tryOut(TrafficClass traffic) const;
  Made pack(std::span<const SendQueue::Next> next, size_t guess) const;
  int64_t backlogOf(std::span<const SendQueue::Next> waiting, size_t guess) const;
  int64_t earliest(int64_t now_us, const Packet& packet) const;
  void send(const Packet& packet, TrafficClass traffic, bool resent, int64_t now_us);

  SenderOptions options_;
  Bus& link_;
  Bus* local_;
  Budget budget_;
  SendQueue queue_;
  HeartbeatPacer heartbeat_;
  std::optional<Made> made_;
  std::array<size_t, kNumTrafficClasses> joined_{};  // how many shared the last datagram of a class
  mutable std::array<Trial, kNumTrafficClasses> trials_{};
  bool heartbeat_went_last_ = false;
  WallPacer pacer_;
  Stats stats_;
};

}  // namespace shoal::comms
