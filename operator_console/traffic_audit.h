// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "shoal/comms/packet.h"
#include "shoal/comms/window_meter.h"
#include "shoal/wire/heartbeat_codec.h"
#include "shoal/wire/message_kind.h"

namespace shoal::console {

/// A time between two heartbeats of a node in which it sent more than was recorded.
struct Gap {
  double from_s = 0, until_s = 0;  ///< mission time of the two; from 0 for what came before the first
  int64_t bytes = 0;               ///< on the wire, that the recording lacks; > 0
};

/// What one process sent, as recorded.
struct NodeTraffic {
  std::string node;
  int32_t pid = 0;     ///< tells a process from the one that took its place; 0: it was not heard to say
  int64_t budget = 0;  ///< bytes/s, as its heartbeats say; 0 = unlimited
  int64_t bytes = 0;   ///< recorded, all headers counted
  size_t datagrams = 0;
  comms::MeteredWindow
      worst;  ///< of those that end in its life; what the process before it sent is in them too
  std::vector<Gap> gaps;
};

/// Meters what nodes put on the link, from a recording: against the budget that each says it has, and
/// against the bytes that each says it has sent. A process that takes the place of another at a later mission
/// time has one budget with it; one whose mission time begins anew, or with another budget, has its own.
class TrafficAudit {
 public:
  /// A message of the mission, in the order of the recording. Whole maps are not on the link: passed over.
  /// @param heartbeat  when it is one.
  void hear(const std::string& node, const wire::Header& header, const comms::Packet& packet,
            const wire::Heartbeat* heartbeat);

  /// By node, then in order of time. Cost: O(n log n) in the datagrams.
  std::vector<NodeTraffic> traffic() const;

 private:
  struct Sent {
    int64_t at_us;
    size_t bytes;
  };
  struct Claim {
    int64_t at_us;
    int64_t lacking;  // bytes it said it had sent, minus those recorded before
  };
  struct Life {
    int32_t pid = 0;
    int64_t budget = 0;
    int64_t bytes = 0;
    std::vector<Sent> sent;  // never empty
    std::vector<Claim> claims;
  };

  static std::vector<Gap> gapsOf(const Life& life);

  std::map<std::string, std::vector<Life>> lives_;
};

}  // namespace shoal::console
