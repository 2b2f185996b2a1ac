// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "shoal/world/grid.h"
#include "shoal/world/observation.h"

namespace shoal::robot {

/// The square of an image that shows a cell and what is around it, two cell edges wide.
struct CellView {
  int left = 0, top = 0;  ///< pixels, of the first one inside
  int side = 0;           ///< pixels, at least 8
};

/// Where an image shows a cell whole: the square lies inside the image, and what the camera saw in the middle
/// of it is the cell, not something before it. Nothing otherwise.
std::optional<CellView> viewOf(const world::Observation& observation, const world::CellIndex& cell,
                               const world::Grid& grid);

/// The square as `edge` x `edge` pixels of red, green and blue, row by row: each the mean of the image's
/// pixels that it covers, rounded, or the nearest when it covers less than one. Integers only.
/// @throws std::invalid_argument unless the image is of type CV_8UC3.
std::vector<uint8_t> cutOut(const world::Observation& observation, const CellView& view, int edge);

}  // namespace shoal::robot
