// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "shoal/eval/evaluation.h"
#include "shoal/world/place.h"
#include "shoal/world/words_in_cells.h"

namespace shoal::eval {

/// All that a team sees of a place: ready to learn from, again and again, without looking again.
struct TeamWords {
  std::vector<std::vector<world::WordsInCells>> robots;     ///< per robot, its images in order
  std::vector<std::pair<world::CellIndex, uint8_t>> truth;  ///< cells that have one, ascending
  double cell_size_m = 0;

  /// True class of a cell, by bisection. Refers to this object.
  TruthOfCell truthOfCell() const;

  /// The same images as one robot would see them that flies all shares, from share `first` on and round;
  /// their words as the robots of the team have them, each with its own camera.
  std::vector<world::WordsInCells> inOneRow(size_t first) const;
};

/// Where words are kept between runs, and how far looking has got.
struct WordCache {
  std::string folder;                      ///< empty: nowhere
  std::string made_by;                     ///< program and world: words of another are not read
  std::atomic<int64_t>* images = nullptr;  ///< grows by one with every image done; may be null
};

/// Flies the team over the place and extracts the words of every image, on all cores; reads what the cache
/// has instead. The cache is keyed by who made it, place, seed, survey and the fingerprint of the words;
/// broken files in it are made anew.
/// @param place_seed  seed that `place` was opened with.
/// @throws std::invalid_argument as Place::source() and vision::makeWordExtractor().
TeamWords lookAround(const world::Place& place, uint64_t place_seed, const world::SurveyOptions& survey,
                     const std::string& profile, const WordCache& cache);

}  // namespace shoal::eval
