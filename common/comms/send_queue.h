// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shoal/comms/packet.h"

namespace shoal::comms {

struct SendQueueOptions {
  /// Shares of the bytes among classes that all have new content waiting, each >= 1.
  int64_t matches_weight = 8;
  int64_t topics_weight = 8;
  int64_t bricks_weight = 4;
  int64_t certainty_weight = 1;
  int64_t pictures_weight = 1;
  int64_t requests_weight = 8;
  int64_t repairs_weight = 1;

  /// Content is not sent again sooner than this after it was last sent, mission time, >= 1. Bounds what an
  /// idle node without a budget sends.
  int64_t min_resend_interval_us = 10'000'000;

  /// How often the same content is sent again, >= 0. Content that others ask for when they lack it needs
  /// none.
  int max_resends = 0;
};

/// What a node has to say, by key: at most one packet, the newest, for each.
///
/// New content goes first. Among classes with new content the bytes are shared by weight (stride scheduling;
/// ties go to the class of higher utility), so that every class drains; a class that had nothing to send
/// saves nothing up. Inside a class, whoever waits longest goes first; newer content takes over the place of
/// older unsent content. When nothing new waits, what was sent least recently is sent again, as often as the
/// options say. Requests and repairs are said once and forgotten. Deterministic. next() then markSent(), so
/// that a budget may stand between the two.
class SendQueue {
 public:
  /// @throws std::invalid_argument when an option is below 1.
  explicit SendQueue(const SendQueueOptions& options = {});

  /// Puts `packet` where `key` was, or adds it. Bytes equal to those already held change nothing, so encode
  /// without the time of sending and let Sender stamp it.
  /// @throws std::invalid_argument for the classes heartbeat and local, for a message above kMaxMessageBytes,
  ///         and when `key` is held in another class.
  /// Cost: O(log keys).
  void offer(TrafficClass traffic, std::string_view key, Packet packet);

  /// Holds `key` no longer. Nothing happens when it was not held.
  void forget(std::string_view key);

  struct Next {
    TrafficClass traffic;
    std::string_view key;  ///< Valid until the next non-const call, as is `packet`.
    const Packet* packet;
    bool resent;  ///< The same content was sent before.
  };

  /// What to send now; nothing when nothing new waits and all was sent recently.
  std::optional<Next> next(int64_t now_us) const;

  /// next(), and up to most - 1 more that may follow it: of its class and on its channel, in the order in
  /// which they would go.
  std::vector<Next> nextOf(int64_t now_us, size_t most) const;

  /// All of a class that waits, in the order in which it would go. Cost: O(what waits).
  std::vector<Next> waiting(TrafficClass traffic) const;

  /// next() was sent. Aborts when there was nothing to send.
  void markSent(int64_t now_us) { markSent(now_us, 1, 0); }

  /// The first `count` of nextOf() were sent as one datagram of so many bytes on the wire; 0 = those of the
  /// packet.
  void markSent(int64_t now_us, size_t count, size_t wire_bytes);

  /// Grows with everything that may change what nextOf() says, but for time.
  uint64_t revision() const { return revision_; }

  /// When content is due to be sent again, if nothing new comes.
  std::optional<int64_t> nextResend() const;

  /// True when `key` is held and its content was not sent yet.
  bool isWaiting(std::string_view key) const;

  /// What is held of `key`, sent or not; null when it is not held. Valid until the next non-const call.
  const Packet* held(std::string_view key) const;

  size_t numKeys() const { return entries_.size(); }
  size_t numWaiting(TrafficClass traffic) const { return of(traffic).waiting.size(); }
  /// On the wire, if every packet went alone.
  int64_t waitingBytes(TrafficClass traffic) const { return of(traffic).waiting_bytes; }
  int64_t waitingBytes() const;  ///< Of all classes.
  /// Grows whenever something of the class begins to wait, waits no longer or waits with other content.
  uint64_t changes(TrafficClass traffic) const { return of(traffic).changes; }

 private:
  struct Entry {
    TrafficClass traffic;
    Packet packet;
    bool waiting;          // else in rotation_, while it is to be sent again
    uint64_t place;        // its key in waiting or rotation_
    int64_t last_sent_us;  // when in rotation
    int num_sent = 0;      // this content
  };
  using Entries = std::map<std::string, Entry, std::less<>>;
  using Line = std::map<uint64_t, Entries::iterator>;
  struct Class {
    int64_t weight = 0;  // 0: not for this queue
    int64_t pass = 0;    // stride scheduling: the class of lowest pass goes next
    int64_t waiting_bytes = 0;
    uint64_t changes = 0;
    Line waiting;
  };

  const Class& of(TrafficClass traffic) const { return classes_[static_cast<size_t>(traffic)]; }
  Class& of(TrafficClass traffic) { return classes_[static_cast<size_t>(traffic)]; }
  const Class* choose() const;
  std::vector<Entries::const_iterator> chosen(int64_t now_us, size_t most) const;
  void await(Entries::iterator it);
  void leave(Entries::iterator it);

  int64_t min_resend_interval_us_;
  int max_resends_;
  std::array<Class, kNumTrafficClasses> classes_;
  int64_t pass_ = 0;  // of the class served last; where a class that was idle joins
  uint64_t next_place_ = 0;
  uint64_t revision_ = 0;
  Entries entries_;
  Line rotation_;  // in order of sending
};

}  // namespace shoal::comms
