// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "operator_console/launch_options.h"
#include "operator_console/supervisor.h"

namespace shoal::console {

/// The processes of a mission, by name: "logger", "OPERATOR", "R00" ..., "single". All write below
/// `options.out`, logs into `logs/<name>.log` there. Options are completed() ones, with `lcm_url` and
/// `mission` set. Programs are looked up: see programBeside() and programOnPath().

/// lcm-logger into mission.lcmlog, which must not be there.
Command loggerCommand(const LaunchOptions& options);
Command operatorCommand(const LaunchOptions& options);
/// @param epoch    how often it has begun anew
/// @param start_s  mission time at which it begins; above 0 it has been running before, and its log goes on
Command robotCommand(const LaunchOptions& options, int robot, int epoch = 0, double start_s = 0);
/// One robot that flies everybody's shares alone, off the link and as fast as it can.
Command singleCommand(const LaunchOptions& options);

/// Files of a mission.
std::string recordingPath(const LaunchOptions& options);
std::string operatorStateDir(const LaunchOptions& options);
/// Where robots keep their checkpoints.
std::string checkpointDir(const LaunchOptions& options);

}  // namespace shoal::console
