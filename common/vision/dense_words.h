// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "shoal/vision/dense_search.h"
#include "shoal/vision/dense_vocabulary.h"
#include "shoal/vision/photometric_correction.h"
#include "shoal/vision/word_extractor.h"

namespace shoal::vision {

/// The words of profile "best": at a point of every 8 x 8 pixels one word of each kind of dense feature
/// (dense_features.h), each kind a word group of its own, after the robot's own brightness and colour cast
/// are taken out (photometric_correction.h). A picture of 320 x 240 has 1200 points and 8400 words.
class DenseWords : public WordExtractor {
 public:
  /// @throws std::invalid_argument unless the vocabulary has one list for each kind of feature, in order, of
  ///         its name and dimensions; numbers of words are free.
  explicit DenseWords(const DenseVocabulary& vocabulary);

  const std::vector<world::WordGroup>& groups() const override { return groups_; }
  uint64_t fingerprint() const override { return fingerprint_; }

  /// The image counts for its own correction.
  /// @throws std::invalid_argument when the observation's images differ in size or type or are under 8 pixels
  ///         wide or high; such an observation does not count.
  world::WordsInCells extract(const world::Observation& observation, const world::Grid& grid) override;

  std::vector<int64_t> learnt() const override;
  void resume(std::span<const int64_t> learnt) override;

 private:
  std::vector<DenseSearch> searches_;  // by kind
  std::vector<world::WordGroup> groups_;
  uint64_t fingerprint_;
  PhotometricCorrection correction_;
};

}  // namespace shoal::vision
