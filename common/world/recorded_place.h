// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "shoal/world/place.h"

namespace shoal::world {

/// True for a folder with groundtruth.txt, rgb.txt or rgb/, and for a folder of folders robot0, robot1, ...
bool isRecording(const std::filesystem::path& folder);

/// The recordings of a team as a place: robot n flies robotn again, frame by frame, each from time 0. Fewer
/// observations than recorded frames are spread evenly over the recording. The cell size that is filled in is
/// 24 pixels at the median depth, rounded to two digits.
/// @param seed  of the sensors' faults, where they are asked for on top of what was recorded.
/// @throws std::invalid_argument as readRecording(), when a robot is missing in the numbering, or when robots
///         disagree about the classes.
std::unique_ptr<Place> openRecording(const std::filesystem::path& folder, uint64_t seed,
                                     const std::optional<Camera>& camera);

}  // namespace shoal::world
