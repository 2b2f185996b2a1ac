// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>

#include "shoal/comms/packet.h"

namespace shoal::comms {

struct Stats;

/// Everybody hears everybody, unreliably: packets may be lost, doubled or reordered.
class Bus {
 public:
  virtual ~Bus() = default;

  /// Sends now. Never fails visibly: a multicast sender cannot know.
  virtual void publish(const Packet& packet) = 0;

  /// Delivers every packet waiting, own ones included, in the calling thread; waits up to `timeout_ms` for
  /// the first. Returns the number delivered. `handler` may publish.
  virtual int receive(int timeout_ms, const std::function<void(const Packet&)>& handler) = 0;

  /// What publish() adds to the bytes of each message. Whoever counts bytes writes it into Packet::trailer.
  virtual size_t trailerBytes() const { return 0; }

  /// From now on, what a bus itself refuses is counted there, by reason. `stats` outlives the last receive().
  virtual void countInto(Stats& /*stats*/) {}
};

}  // namespace shoal::comms
