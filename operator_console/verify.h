// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "operator_console/recorded_mission.h"
#include "operator_console/traffic_audit.h"

namespace shoal::console {

/// What a recording says about how a mission went over the link.
struct Verification {
  std::string log;
  RecordedMission recorded;
  std::vector<NodeTraffic> traffic;          ///< budgets, worst windows and gaps
  std::vector<std::string> lacking;          ///< pieces that the recording does not hold: gaps not repaired
  std::optional<double> landed_s, agreed_s;  ///< mission time by the clock that was furthest
  std::vector<std::string> disagreements;    ///< at the end
  std::vector<std::string> mixed;  ///< what must not meet: twins, missions, vocabularies, cell sizes

  bool budgetKept() const;
  /// All that is wrong, a line each; empty when the mission was in order.
  std::vector<std::string> wrong() const;
  nlohmann::ordered_json json() const;  ///< docs/schemas/verify.schema.json
  std::string text() const;
};

/// Was the budget kept, in every window of a second or more, by every node? Was all that the recorder missed
/// said again? When did all nodes agree, and do they hold what the recording adds up to?
///
/// Budgets, and what was sent, are what the heartbeats say; a node that hides its sending cannot be told from
/// one whose messages were lost.
/// @throws std::runtime_error when the recording cannot be read or holds no heartbeat.
/// @param key_file  as MessageLog().
Verification verify(const std::string& log, const std::string& key_file = {});

}  // namespace shoal::console
