// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "shoal/world/reef_world.h"
#include "shoal/world/world.h"
#include "shoal/world/world_folder.h"

namespace shoal::world {
namespace fs = std::filesystem;

std::unique_ptr<World> openWorld(const std::string& spec, uint64_t seed) {
  if (spec.rfind("reef:", 0) == 0) return std::make_unique<ReefWorld>(reefStyle(spec), seed);
  if (spec.rfind("lcm:", 0) == 0) {
    throw std::invalid_argument(spec + ": a live camera is one robot's own: start robot_agent --source " +
                                spec +
                                " on each robot, and a fusion_node; fly a world folder, a recording or " +
                                "reef:sparse, reef:varied, reef:tuning here");
  }
  const fs::path folder(spec);
  std::error_code error;
  if (spec.empty() || !fs::exists(folder, error)) {
    throw std::invalid_argument(
        "no world '" + spec +
        "': it must be a folder that holds world.json or an RGB-D recording, or one of " +
        "reef:sparse, reef:varied, reef:tuning");
  }
  if (!fs::is_directory(folder, error)) {
    throw std::invalid_argument(spec + ": is a file; a world is the folder that holds world.json");
  }
  return readWorldFolder(folder);
}

}  // namespace shoal::world
