// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "shoal/mapping/queries.h"

namespace shoal::mapping {

/// The answer to `diff T1 T2`: how the map changed between two moments.
///
/// A cell has "appeared", was "seen" again since and got another label, was "relabelled" without being seen
/// again (its robot or the matching thought otherwise), or is "gone". A change counts for the robot whose
/// observation the later map shows there (the earlier one for cells that are gone). Labels are listed when
/// they are on either map, with their ground before and after.
///
/// @param before_s, after_s  mission times of the two views, seconds; told, not checked.
/// Cost: O(cells).
nlohmann::ordered_json diffAnswer(const MissionView& before, double before_s, const MissionView& after,
                                  double after_s);

/// Its changes as CSV, a row a cell: x_m,y_m,z_m,change,before,after,robot,seen_s; labels empty where there
/// is none. @param diff  a diffAnswer().
std::string diffCsv(const nlohmann::ordered_json& diff);

}  // namespace shoal::mapping
