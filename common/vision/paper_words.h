// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "shoal/vision/pixel_word.h"
#include "shoal/vision/vocabulary.h"
#include "shoal/vision/word_extractor.h"
#include "shoal/vision/word_search.h"

namespace shoal::vision {

/// The words of profile "paper": ORB on the L, a and b channels, each with an id range of its own over one
/// vocabulary, then hue and intensity. With the 5000 words of the shipped vocabulary 15436 words in all.
///
/// Source: S. Jamieson et al. 2021 and its implementation Sunshine. We differ in three
/// places: the nearest word is exact, not approximate; words without a valid depth are dropped; and key
/// points are found on the equalised L itself, not on an L that went through BGR and back. Pictures of
/// ground seldom have corners in 8-bit a and b, so those groups may stay nearly empty.
///
/// No state beyond the vocabulary: what an image gives does not depend on the images before it.
class PaperWords : public WordExtractor {
 public:
  explicit PaperWords(const Vocabulary& vocabulary);

  const std::vector<world::WordGroup>& groups() const override { return groups_; }
  uint64_t fingerprint() const override { return fingerprint_; }

  /// @throws std::invalid_argument when the observation's images differ in size or type or are under 32
  ///         pixels wide or high.
  world::WordsInCells extract(const world::Observation& observation, const world::Grid& grid) override;

 private:
  std::vector<PixelWord> words(const cv::Mat& bgr) const;

  WordSearch search_;
  std::vector<world::WordGroup> groups_;
  uint64_t fingerprint_;
};

}  // namespace shoal::vision
