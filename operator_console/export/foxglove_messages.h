// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "shoal/mapping/queries.h"

namespace shoal::console {

/// Messages in Foxglove's schemas, as JSON. Stamps are mission time in nanoseconds, the frame is "mission".

/// 0 for times before the mission.
uint64_t foxgloveTime(double seconds);
nlohmann::ordered_json foxgloveStamp(uint64_t ns);

/// foxglove.PointCloud: a point a cell, float32 x y z, uint8 red green blue alpha, int32 label, float32
/// certainty, uint16 robot, float32 age (seconds before the newest).
nlohmann::ordered_json foxgloveCloud(std::span<const mapping::GlobalCell> cells, double cell_size_m,
                                     uint64_t ns);

/// foxglove.FrameTransform of a robot where it was last heard: its place, for its turn is not known.
nlohmann::ordered_json foxgloveTransform(const mapping::NodeStatus& node);

/// foxglove.Log. @param node  who it is about; may be empty.
nlohmann::ordered_json foxgloveLog(uint64_t ns, bool is_bad, const std::string& text,
                                   const std::string& node);

}  // namespace shoal::console
