// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "operator_console/launch_options.h"

namespace shoal::console {

/// Flies a mission on this host: starts a robot_agent for each robot and a fusion_node, with lcm-logger and a
/// lone robot when asked; shows how they get on; ends them when every robot has landed and all nodes agree;
/// writes the summary. None of them outlives it.
///
/// @returns the exit code: 0; 1 when a process died, the nodes never agreed or another mission was heard,
///          after a line that says which; 128 + n after signal n. What had been written stays.
/// @throws std::invalid_argument naming a wrong option, before anything is started.
int launch(LaunchOptions options);

}  // namespace shoal::console
