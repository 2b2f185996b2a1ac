// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>

#include "shoal/world/ortho_world.h"

namespace shoal::world {

/// Reads a world folder: world.json and the pictures that it names.
///
/// world.json is an object with metres_per_pixel (> 0), size_px [width, height] and image (a file name); with
/// classes [{id, name, rgb}] and labels (a file name: one 8-bit channel, a class id per pixel, 255 =
/// unlabelled) together or not at all; name defaults to the folder's. Other keys are ignored.
/// @throws std::invalid_argument naming the file and what would be right.
///
/// Cost: four bytes of memory a pixel.
std::unique_ptr<OrthoWorld> readWorldFolder(const std::filesystem::path& folder);

}  // namespace shoal::world
