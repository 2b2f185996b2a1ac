// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "shoal/vision/pixel_word.h"
#include "shoal/world/grid.h"
#include "shoal/world/observation.h"
#include "shoal/world/words_in_cells.h"

namespace shoal::vision {

/// Puts words of an image into cells: the point that the depth image has at the word's pixel, through the
/// pose, in the cell that holds it. A word whose depth is not finite or not above 0, or whose point lies
/// outside what a cell index can count, is dropped and counted. The order of `words` does not matter. Cost:
/// O(n log n) in words.
/// @throws std::invalid_argument when colour, depth and intrinsics differ in size, are not CV_8UC3 and
///         CV_32FC1, or intrinsics or pose are not finite.
world::WordsInCells placeWords(std::span<const PixelWord> words, const world::Observation& observation,
                               const world::Grid& grid);

/// The checks of placeWords() alone.
void checkObservation(const world::Observation& observation);

}  // namespace shoal::vision
