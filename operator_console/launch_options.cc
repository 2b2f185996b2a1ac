// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/launch_options.h"

#include <cmath>
#include <stdexcept>

#include "fusion_node/process.h"
#include "shoal/comms/lcm_url.h"
#include "shoal/comms/link_model.h"
#include "shoal/comms/seal.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/mapping/library.h"
#include "shoal/mapping/local_belief.h"
#include "shoal/robot/known_topics_file.h"

namespace shoal::console {
namespace {

void demandPositive(const std::string& flag, double value) {
  if (!(value > 0) || !std::isfinite(value)) {
    throw std::invalid_argument(flag + " must be a positive number, got " + std::to_string(value));
  }
}

}  // namespace

void check(const LaunchOptions& options) {
  if (options.world.empty()) throw std::invalid_argument("--world is missing, as in --world reef:sparse");
  if (options.out.empty()) throw std::invalid_argument("--out is missing: a folder for the mission's files");
  if (options.num_robots < 0 || options.num_robots > 256) {
    throw std::invalid_argument("--robots must lie in 1 to 256, or be 0 (as many as there are), got " +
                                std::to_string(options.num_robots));
  }
  if (options.observations < 0) {
    throw std::invalid_argument("--observations must be 0 (as many as cover the area) or more, got " +
                                std::to_string(options.observations));
  }
  if (options.budget < 0 || options.budget > INT32_MAX) {
    throw std::invalid_argument("--budget must be 0 (unlimited) to 2147483647 bytes per second, got " +
                                std::to_string(options.budget));
  }
  comms::readLink(options.link);
  if (!options.library.empty()) mapping::parseLibrary(mapping::readFile(options.library), options.library);
  if (!options.key.empty()) comms::SealKey::read(options.key);
  if (options.profile != "best" && options.profile != "paper") {
    throw std::invalid_argument("--profile must be best or paper, got \"" + options.profile + "\"");
  }
  if (!options.bootstrap.empty()) robot::readKnownTopics(options.bootstrap, options.profile);
  if (!mapping::parseDetail(options.detail)) {
    throw std::invalid_argument("--detail must be fine or coarse, got \"" + options.detail + "\"");
  }
  matching::check(options.matcher);
  fusion_node::parseRate(options.rate);
  demandPositive("--frame-period-s", options.frame_period_s);
  demandPositive("--settle-timeout-s", options.settle_timeout_s);
  if (options.cell_size_m != 0) demandPositive("--cell-size-m", options.cell_size_m);
  if (options.altitude_m != 0) demandPositive("--altitude-m", options.altitude_m);
  world::checkSensors(options.sensors);
  if (options.mission < 0) throw std::invalid_argument("--mission must be a positive number");
  if (!options.lcm_url.empty()) comms::parseUrl(options.lcm_url);
}

LaunchOptions completed(LaunchOptions options) {
  const auto place = openPlace(options);
  if (options.num_robots == 0) options.num_robots = place->isRecorded() ? place->maxRobots() : 12;
  const world::SurveyOptions team = place->completed(surveyOf(options));
  options.observations = team.observations;
  options.cell_size_m = team.cell_size_m;
  options.altitude_m = team.altitude_m;
  return options;
}

std::unique_ptr<world::Place> openPlace(const LaunchOptions& options) {
  return world::openPlace(
      options.world, options.seed,
      options.camera.empty() ? std::nullopt : std::optional(world::readCamera(options.camera)));
}

world::SurveyOptions surveyOf(const LaunchOptions& options) {
  world::SurveyOptions team;
  if (!options.camera.empty()) team.intrinsics = world::readCamera(options.camera).intrinsics;
  team.num_robots = options.num_robots;
  team.observations = options.observations;
  team.cell_size_m = options.cell_size_m;
  team.altitude_m = options.altitude_m;
  team.frame_period_s = options.frame_period_s;
  team.sensors = options.sensors;
  return team;
}

}  // namespace shoal::console
