// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "shoal/comms/bus.h"
#include "shoal/comms/link_model.h"
#include "shoal/comms/wall_time.h"

namespace shoal::comms {

/// What can be seen of a message on the air.
struct OnAir {
  int64_t sent_us = 0;  ///< mission time of sending, by the sender's clock, >= 0
  std::optional<std::array<double, 3>> position_m = {};  ///< where the sender is, when the message says so
};

struct LinkEmulatorOptions {
  std::string receiver = {};  ///< the node that listens: what is its own passes
  uint64_t seed = 0;          ///< same seed, same arrivals: same fate
  double rate = 0;            ///< seconds of mission time per second of wall time, 0 = as fast as possible
  WallTime wall = realWallTime();

  /// Nothing for what is not of the link (rubbish, another mission, what is said to this host alone): that
  /// passes as it is. Must be set.
  std::function<std::optional<OnAir>(const Packet&)> look = {};
};

/// What became of the messages of others.
struct LinkCounts {
  uint64_t sent = 0;          ///< on the air
  uint64_t delivered = 0;     ///< copies too
  uint64_t overflowed = 0;    ///< more than the rate carries
  uint64_t out_of_range = 0;  ///< too far away
  uint64_t parted = 0;        ///< in another group of a partition
  uint64_t faded = 0;         ///< lost in a bad time
  uint64_t lost = 0;          ///< lost otherwise
  uint64_t doubled = 0;       ///< came twice
  uint64_t overtaken = 0;     ///< held back, so that what was sent later may overtake
};

/// A bus as one node hears it over a link: what others publish is lost, held up, doubled and disordered as
/// the model says, on the receiving side, so that senders and recorders see the air as it is.
///
/// The fate of the n-th message that arrives from a sender is a pure function of (seed, sender, receiver, n)
/// and, for fades, range and partitions, of its time of sending. Time is mission time by the sender's clock:
/// a message is delivered when that clock has passed its arrival, which is known from the times of sending
/// of what came later and, unless the rate is 0, from the wall clock in between. So at rate 0 what is
/// delivered, and in which order, depends on what arrives and in which order, and on nothing else. A sender
/// whose clock steps back by more than a minute has begun anew.
class LinkEmulator final : public Bus {
 public:
  /// `air` outlives it.
  /// @throws std::invalid_argument as check(model), or when `look` is not set.
  LinkEmulator(Bus& air, const LinkModel& model, LinkEmulatorOptions options);

  void publish(const Packet& packet) override;

  /// Delivers what has come through; waits no longer than until the next message is due. Returns the number
  /// delivered, which may be 0 although something was on the air.
  int receive(int timeout_ms, const std::function<void(const Packet&)>& handler) override;

  size_t trailerBytes() const override { return air_.trailerBytes(); }
  void countInto(Stats& stats) override { air_.countInto(stats); }

  const LinkCounts& counts() const { return counts_; }

  /// Messages on their way: at most 65536, what comes above that is dropped as overflow.
  size_t numHeld() const { return num_held_; }

 private:
  using Position = std::optional<std::array<double, 3>>;
  using Handler = std::function<void(const Packet&)>;
  struct Sender {
    uint64_t key = 0;                     // of its random numbers, with this receiver
    uint64_t num_sent = 0;                // its messages so far
    int64_t clock_us = 0;                 // its mission time ...
    int64_t wall_us = 0;                  // ... at this wall time
    int64_t idle_us = 0;                  // when its radio has sent all that it was given
    int64_t last_due_us = 0;              // of what keeps its order
    Position position_m;                  // as it said last
    std::multimap<int64_t, Packet> held;  // by the time at which each is due
  };

  Sender* senderOf(const std::string& name);
  void take(const Packet& packet, const OnAir& on_air, const std::string& name, Sender& sender);
  bool comesThrough(const OnAir& on_air, const std::string& name, const Sender& sender, double chance);
  bool isParted(const std::string& name, int64_t sent_us) const;
  bool isOutOfRange(const Sender& sender) const;
  void hold(Sender& sender, int64_t due_us, const Packet& packet);
  int64_t clockOf(const Sender& sender) const;
  void deliver(Sender& sender, int64_t until_us, const Handler& handler);
  int shortened(int timeout_ms) const;

  Bus& air_;
  LinkModel model_;
  LinkEmulatorOptions options_;
  std::map<std::string, Sender> senders_;
  Position own_position_m_;
  LinkCounts counts_;
  size_t num_held_ = 0;
  int num_delivered_ = 0;  // in the present receive()
};

}  // namespace shoal::comms
