// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "shoal/comms/packet.h"

namespace shoal::comms {

/// Bytes are bytes on the wire, headers included.
struct SentCount {
  uint64_t datagrams = 0;
  uint64_t bytes = 0;
  uint64_t resent_datagrams = 0;  ///< Of these, sent again without being new.
  uint64_t resent_bytes = 0;
};

/// What a process sent, by class, and what it refused from others, by reason.
struct Stats {
  std::array<SentCount, kNumTrafficClasses> sent;
  std::map<std::string, uint64_t, std::less<>> rejected;  ///< Reasons are the caller's, a fixed few.

  void countSent(TrafficClass traffic, size_t wire_bytes, bool resent) {
    SentCount& count = sent[static_cast<size_t>(traffic)];
    ++count.datagrams;
    count.bytes += wire_bytes;
    if (!resent) return;
    ++count.resent_datagrams;
    count.resent_bytes += wire_bytes;
  }

  void countRejected(std::string_view reason) {
    const auto found = rejected.find(reason);
    if (found == rejected.end()) {
      rejected.emplace(reason, 1);
    } else {
      ++found->second;
    }
  }

  const SentCount& of(TrafficClass traffic) const { return sent[static_cast<size_t>(traffic)]; }

  /// Bytes on the link: all classes but kLocal.
  uint64_t linkBytes() const {
    uint64_t bytes = 0;
    for (const SentCount& count : sent) bytes += count.bytes;
    return bytes - of(TrafficClass::kLocal).bytes;
  }
};

}  // namespace shoal::comms
