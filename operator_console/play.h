// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "shoal/comms/bus.h"

namespace shoal::console {

struct Played {
  int64_t images = 0, depths = 0, poses = 0, unreadable = 0;
};

/// Says on a bus what the cameras of a real robot would: the pictures and poses of an RGB-D folder in TUM
/// layout, in the order of their times, as PREFIX_IMAGE, PREFIX_DEPTH and PREFIX_POSE. What it needs of the
/// folder are its lists and pictures; what is said at one time comes pose first, colour last.
/// @param rate  seconds of the recording per wall second; 0 = as fast as receivers' buffers allow.
/// @throws std::invalid_argument naming what is missing in the folder, or a bad prefix or rate.
Played play(const std::filesystem::path& folder, const std::string& prefix, double rate, comms::Bus& bus);

}  // namespace shoal::console
