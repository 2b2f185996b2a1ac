// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "shoal/robot/explorer.h"
#include "shoal/world/source.h"

namespace shoal::robot_agent {

/// One robot that explores alone and tells nobody: the paper's comparator. Flies the source to its end, or
/// until a stop is requested, and writes its files into `out_dir`.
/// @throws std::runtime_error when they cannot be written.
void runAlone(const robot::ExplorerOptions& options, world::ObservationSource& source,
              const std::string& out_dir);

}  // namespace shoal::robot_agent
