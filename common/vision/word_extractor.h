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

/// Turns the images of one robot into visual words placed in cells of the map by depth and pose.
///
/// It may learn about the robot's camera from image to image: one object belongs to one robot and one thread,
/// and takes that robot's images in order.
class WordExtractor {
 public:
  virtual ~WordExtractor() = default;

  /// Word groups in id order; together they tile [0, vocabulary size).
  virtual const std::vector<world::WordGroup>& groups() const = 0;

  /// Identifies vocabulary and extraction parameters: robots may only be matched when it is equal.
  virtual uint64_t fingerprint() const = 0;

  /// Words of the next image. Words at pixels without valid depth are dropped and counted. A pure function of
  /// the images so far.
  /// @throws std::invalid_argument when images of the observation differ in size or type.
  virtual world::WordsInCells extract(const world::Observation& observation, const world::Grid& grid) = 0;

  /// What it has learnt about the robot's camera, as numbers: an extractor of the same fingerprint that
  /// resumes from them goes on as this one does.
  virtual std::vector<int64_t> learnt() const { return {}; }

  /// @throws std::invalid_argument for what learnt() does not give.
  virtual void resume(std::span<const int64_t> learnt);

  int32_t vocabularySize() const { return groups().back().first + groups().back().size; }
};

/// The extractor of a profile, "paper" or "best", with the vocabulary that is built into this library.
/// @throws std::invalid_argument naming a profile that is unknown.
std::unique_ptr<WordExtractor> makeWordExtractor(const std::string& profile);

/// The same with a vocabulary of the caller's, in the format of vocabulary.h ("paper") or dense_vocabulary.h
/// ("best").
/// @throws std::invalid_argument naming the profile, or what is wrong with the vocabulary.
std::unique_ptr<WordExtractor> makeWordExtractor(const std::string& profile,
                                                 std::span<const uint8_t> vocabulary_bytes);

}  // namespace shoal::vision
