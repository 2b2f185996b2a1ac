// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

#include "shoal/comms/mission_clock.h"
#include "shoal/comms/sender.h"

namespace shoal::fusion_node {

/// Says one more heartbeat, now or as soon as the budget lets it, also when a stop was requested: else who
/// ends in good order would seem lost. Waits no longer than `patience` of wall time for the budget.
/// @returns true when it went out.
bool sayLastHeartbeat(comms::Sender& sender, comms::MissionClock& clock,
                      std::chrono::microseconds patience = std::chrono::seconds(3));

}  // namespace shoal::fusion_node
