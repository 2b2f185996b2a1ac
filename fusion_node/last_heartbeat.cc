// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/last_heartbeat.h"

#include <cstdint>

namespace shoal::fusion_node {

bool sayLastHeartbeat(comms::Sender& sender, comms::MissionClock& clock, std::chrono::microseconds patience) {
  const auto said = [&sender] {
    return sender.stats().sent[static_cast<size_t>(comms::TrafficClass::kHeartbeat)].datagrams;
  };
  const auto before = said();
  sender.hurryHeartbeat(clock.now());
  int64_t left_us = patience.count();
  while (true) {
    const int64_t next_us = sender.pump(clock.now());
    if (said() != before) return true;
    const int64_t wait_us = clock.wallUntil(next_us);
    if (next_us == comms::Sender::kNever || wait_us > left_us) return false;
    left_us -= wait_us;
    clock.waitUntil(next_us);
  }
}

}  // namespace shoal::fusion_node
