// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/mission_commands.h"

#include <array>
#include <charconv>
#include <utility>

#include "shoal/comms/lcm_url.h"
#include "shoal/demand.h"
#include "shoal/world/ids.h"

namespace shoal::console {
namespace {

// Shortest text that reads back as the same number.
std::string text(double value) {
  std::array<char, 32> buffer{};
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  SHOAL_DEMAND(error == std::errc{});
  return {buffer.data(), end};
}

std::string logPath(const LaunchOptions& options, const std::string& name) {
  return options.out + "/logs/" + name + ".log";
}

void append(std::vector<std::string>& arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
}

// What decides what is seen and learnt: the same for a robot of the team and the one that flies alone.
std::vector<std::string> flightArguments(const LaunchOptions& options) {
  std::vector<std::string> arguments = {"--source",         options.world,
                                        "--robots",         std::to_string(options.num_robots),
                                        "--observations",   std::to_string(options.observations),
                                        "--seed",           std::to_string(options.seed),
                                        "--profile",        options.profile,
                                        "--detail",         options.detail,
                                        "--cell-size-m",    text(options.cell_size_m),
                                        "--frame-period-s", text(options.frame_period_s),
                                        "--log-level",      options.log_level};
  if (options.altitude_m > 0) append(arguments, {"--altitude-m", text(options.altitude_m)});
  const world::SensorOptions& sensors = options.sensors;
  for (const auto& [flag, value] : {std::pair("--exposure", sensors.exposure),
                                    {"--color-cast", sensors.color_cast},
                                    {"--pose-drift", sensors.pose_drift},
                                    {"--depth-noise", sensors.depth_noise},
                                    {"--depth-holes", sensors.depth_holes}}) {
    if (value != 0) append(arguments, {flag, text(value)});
  }
  if (!options.camera.empty()) append(arguments, {"--camera", options.camera});
  if (!options.bootstrap.empty()) append(arguments, {"--bootstrap", options.bootstrap});
  return arguments;
}

std::vector<std::string> linkArguments(const LaunchOptions& options) {
  std::vector<std::string> arguments = {
      "--lcm-url", options.lcm_url, "--budget",  std::to_string(options.budget),
      "--rate",    options.rate,    "--mission", std::to_string(options.mission),
      "--link",    options.link};
  if (!options.key.empty()) append(arguments, {"--key", options.key});
  return arguments;
}

}  // namespace

Command loggerCommand(const LaunchOptions& options) {
  return {"logger",
          programOnPath("lcm-logger", "liblcm-bin"),
          {"--lcm-url=" + comms::withReceiveBuffer(options.lcm_url), recordingPath(options)},
          logPath(options, "logger")};
}

Command operatorCommand(const LaunchOptions& options) {
  std::vector<std::string> arguments = {"--node", "OPERATOR"};
  append(arguments, linkArguments(options));
  append(arguments, {"--seed", std::to_string(options.seed), "--matcher", options.matcher.matcher,
                     "--similarity", options.matcher.similarity, "--sigma",
                     options.matcher.sigma ? text(*options.matcher.sigma) : "auto", "--cell-size-m",
                     text(options.cell_size_m), "--out", options.out, "--state", operatorStateDir(options),
                     "--log-level", options.log_level});
  if (!options.library.empty()) append(arguments, {"--library", options.library});
  return {"OPERATOR", programBeside("fusion_node"), arguments, logPath(options, "OPERATOR")};
}

Command robotCommand(const LaunchOptions& options, int robot, int epoch, double start_s) {
  const std::string name = world::name(world::RobotId{robot});
  std::vector<std::string> arguments = {"--robot", name};
  append(arguments, flightArguments(options));
  append(arguments, linkArguments(options));
  append(arguments, {"--out", options.out, "--linger", "--checkpoint", checkpointDir(options)});
  if (!options.looks_again) arguments.push_back("--no-look-again");
  append(arguments, {"--epoch", std::to_string(epoch), "--start-s", text(start_s)});
  return {name, programBeside("robot_agent"), arguments, logPath(options, name), start_s > 0};
}

Command singleCommand(const LaunchOptions& options) {
  std::vector<std::string> arguments = {"--single", "--robot", "R00"};
  append(arguments, flightArguments(options));
  append(arguments, {"--rate", "max", "--out", options.out + "/single"});
  return {"single", programBeside("robot_agent"), arguments, logPath(options, "single")};
}

std::string recordingPath(const LaunchOptions& options) { return options.out + "/mission.lcmlog"; }

std::string operatorStateDir(const LaunchOptions& options) { return options.out + "/state"; }

std::string checkpointDir(const LaunchOptions& options) { return operatorStateDir(options) + "/robots"; }

}  // namespace shoal::console
