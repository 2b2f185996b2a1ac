// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "shoal/world/grid.h"
#include "shoal/world/observation.h"
#include "shoal/world/words_in_cells.h"

namespace shoal::vision {

/// Turns an image into visual words placed in cells of the map by depth and pose.
class WordExtractor {
 public:
  virtual ~WordExtractor() = default;

  /// Word groups in id order; together they tile [0, vocabulary size).
  virtual const std::vector<world::WordGroup>& groups() const = 0;

  /// Identifies vocabulary and extraction parameters: robots may only be matched when it is equal.
  virtual uint64_t fingerprint() const = 0;

  /// Words of one image. Words at pixels without valid depth are dropped and counted. Pure.
  /// @throws std::invalid_argument when images of the observation differ in size or type.
  virtual world::WordsInCells extract(const world::Observation& observation,
                                      const world::Grid& grid) const = 0;

  int32_t vocabularySize() const { return groups().back().first + groups().back().size; }
};

/// The extractor of a profile ("paper") with the vocabulary that is built into this library.
/// @throws std::invalid_argument naming a profile that is unknown or not built yet.
std::unique_ptr<WordExtractor> makeWordExtractor(const std::string& profile);

/// The same with a vocabulary of the caller's, in the format of vocabulary.h.
/// @throws std::invalid_argument naming the profile, or what is wrong with the vocabulary.
std::unique_ptr<WordExtractor> makeWordExtractor(const std::string& profile,
                                                 std::span<const uint8_t> vocabulary_bytes);

}  // namespace shoal::vision
