// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "shoal/matching/matcher.h"
#include "shoal/world/place.h"

namespace shoal::console {

/// A mission as `launch` flies it.
struct LaunchOptions {
  std::string world;           ///< reef:sparse, reef:varied, reef:tuning, a world folder or a recording
  int num_robots = 0;          ///< in [1, 256]; 0 = 12 over a world, as many as were recorded
  int32_t observations = 250;  ///< per robot, 0 = as many as cover the share, or all
  uint64_t seed = 1;
  int64_t budget = 2000;       ///< bytes per second of mission time, each; 0 = unlimited
  std::string link = "clean";  ///< clean, mesh, acoustic, satellite or a file: docs/link.md
  std::string key;             ///< file with the team's key; empty = messages carry no seal
  std::string rate = "max";    ///< mission seconds per wall second, or "max"
  std::string profile = "best";
  std::string bootstrap;        ///< topics.json to begin with; empty: none
  std::string detail = "fine";  ///< of topics and certainties on the link: fine or coarse
  bool looks_again = true;      ///< robots at their maps, when all have landed
  matching::MatcherOptions matcher = matching::usualMatcher();
  double cell_size_m = 0;  ///< 0 = the world's own
  double altitude_m = 0;   ///< 0 = native resolution
  double frame_period_s = 1;
  world::SensorOptions sensors;
  std::string camera;             ///< camera.json that says how the camera sees; empty = as usual there
  std::string out;                ///< folder
  bool overwrite = false;         ///< a mission in `out`, ended or not, may go
  bool single = false;            ///< fly one robot over the whole area too
  bool record = false;            ///< mission.lcmlog
  std::string lcm_url;            ///< empty = on a free port
  int32_t mission = 0;            ///< 0 = a number of its own
  double settle_timeout_s = 300;  ///< wall time without any change after which a landed team is given up
  std::string library;            ///< file of names from missions before; empty = none
  std::string kill_plan;          ///< file of crashes on schedule: kill_plan.h; empty = none
  std::string log_level = "info";
};

/// @throws std::invalid_argument naming the option that is wrong, and what would be right.
void check(const LaunchOptions& options);

/// The same with the number of robots, the cell size and the altitude that the place says where they were
/// left open.
/// @throws std::invalid_argument when the place cannot be opened, or cannot be flown like that.
LaunchOptions completed(LaunchOptions options);

/// Where the team flies. @throws std::invalid_argument when it cannot be opened.
std::unique_ptr<world::Place> openPlace(const LaunchOptions& options);

/// How the team flies. @throws std::invalid_argument when the camera's file is wrong.
world::SurveyOptions surveyOf(const LaunchOptions& options);

}  // namespace shoal::console
