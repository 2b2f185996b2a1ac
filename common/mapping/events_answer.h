// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "shoal/mapping/belief_store.h"
#include "shoal/mapping/queries.h"

namespace shoal::mapping {

/// Something that happened to a node of a mission, as one listener saw it.
struct MissionEvent {
  double at_s = 0;   ///< mission time
  std::string kind;  ///< joined, landed, looked, leaving, again, lost, back, twin, refused, mission
  std::string node;  ///< whom it happened to
  std::string says;  ///< for people
  bool operator==(const MissionEvent&) const = default;
};

/// What happened, the earliest first: {"events": [{"at_s", "kind", "node", "says"}]}. To what was seen come
/// the labels of the map, by when they were first seen ("label"), and what operators decided ("edit").
nlohmann::ordered_json eventsAnswer(const MissionView& view, const BeliefStore& beliefs,
                                    std::span<const MissionEvent> seen);

}  // namespace shoal::mapping
