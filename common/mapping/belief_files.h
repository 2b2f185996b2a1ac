// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "shoal/mapping/local_belief.h"
#include "shoal/world/grid.h"

namespace shoal::mapping {

/// The topics of a robot alone: topics.json at `path`, words ascending. @throws std::runtime_error naming the
/// file and what is wrong.
LocalBelief readTopics(const std::string& path);

/// What surprised the robot as surprise.csv: x_m,y_m,z_m,surprise, as it travels (surpriseSteps()); ascending
/// by cell.
std::string surpriseCsv(const LocalBelief& belief, const world::Grid& grid);

/// The labelled cells of a belief as map.csv: x_m,y_m,z_m,topic,seen_s,certainty; ascending by cell.
std::string beliefCsv(const LocalBelief& belief, const world::Grid& grid);

/// Writes `FOLDER/map.csv` and `FOLDER/topics.json` (exact counts).
/// @throws std::runtime_error naming the file that cannot be written.
void writeBelief(const std::string& folder, const LocalBelief& belief, const world::Grid& grid);

/// Reads what writeBelief() wrote; seconds come back to the millisecond.
/// @throws std::runtime_error naming the file and what is wrong with it.
LocalBelief readBelief(const std::string& folder, world::RobotId robot, const world::Grid& grid);

}  // namespace shoal::mapping
