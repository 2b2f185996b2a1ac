// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "shoal/matching/matcher.h"
#include "shoal/world/survey.h"

namespace shoal::console {

/// A mission as `launch` flies it.
struct LaunchOptions {
  std::string world;           ///< reef:sparse, reef:varied, reef:tuning or a world folder
  int num_robots = 12;         ///< in [1, 256]
  int32_t observations = 250;  ///< per robot, 0 = as many as cover the share
  uint64_t seed = 1;
  int64_t budget = 2000;  ///< bytes per second of mission time, each; 0 = unlimited
  std::string link = "clean";
  std::string rate = "max";  ///< mission seconds per wall second, or "max"
  std::string profile = "paper";
  matching::MatcherOptions matcher;
  double cell_size_m = 0;  ///< 0 = the world's own
  double altitude_m = 0;   ///< 0 = native resolution
  double frame_period_s = 1;
  std::string out;                ///< folder
  bool overwrite = false;         ///< a finished mission in `out` may go
  bool single = false;            ///< fly one robot over the whole area too
  bool record = false;            ///< mission.lcmlog
  std::string lcm_url;            ///< empty = on a free port
  int32_t mission = 0;            ///< 0 = a number of its own
  double settle_timeout_s = 300;  ///< wall time without any change after which a landed team is given up
  std::string log_level = "info";
};

/// @throws std::invalid_argument naming the option that is wrong or not built yet, and what would be right.
void check(const LaunchOptions& options);

/// The same with the world's cell size and the altitude of native resolution where they were left open.
/// @throws std::invalid_argument when the world cannot be opened.
LaunchOptions completed(LaunchOptions options);

/// How the team flies.
world::SurveyOptions surveyOf(const LaunchOptions& options);

}  // namespace shoal::console
