// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <set>
#include <string_view>

#include "shoal/mapping/belief_store.h"

namespace shoal::mapping {

/// How what a robot learns with stands to what most robots of its team learn with.
enum class Comparable {
  kSame,
  kUnknown,               ///< it has not said, while others have
  kOtherWords,            ///< its topics count other things: never matched
  kOtherHyperparameters,  ///< its topics mean other things: never matched
  kOtherCells             ///< its cells lie elsewhere: left out of the map
};
std::string_view toText(Comparable comparable);

/// What most robots have said that they learn with; of equally many, what the lowest robot among them has.
/// Nothing when no robot has said, as of recordings of before: then all count as comparable. A pure function
/// of the state. Cost: O(robots^2).
/// @param excluded  Robots that count as never heard.
std::optional<SettingsPart> commonSettings(const BeliefStore& beliefs,
                                           const std::set<world::RobotId>& excluded);

/// @param common  As commonSettings() says.
Comparable compare(const BeliefStore& beliefs, world::RobotId robot,
                   const std::optional<SettingsPart>& common);

/// The robots whose cells are of another size than most robots'.
std::set<world::RobotId> robotsOfOtherCells(const BeliefStore& beliefs,
                                            const std::set<world::RobotId>& excluded);

}  // namespace shoal::mapping
