// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/dense_words.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

#include "shoal/random.h"
#include "shoal/vision/block_sums.h"
#include "shoal/vision/dense_features.h"
#include "shoal/vision/pixel_word.h"
#include "shoal/vision/placement.h"
#include "shoal/vision/texture_blocks.h"

namespace shoal::vision {
namespace {

// Grows whenever the same pictures and vocabulary would give other words.
constexpr uint64_t kDenseWordsVersion = 1;

void check(const DenseVocabulary& vocabulary) {
  const std::vector<DenseWordList>& lists = vocabulary.lists();
  if (lists.size() != kNumFeatureKinds) {
    throw std::invalid_argument("dense words need a vocabulary of " + std::to_string(kNumFeatureKinds) +
                                " lists, got " + std::to_string(lists.size()));
  }
  for (size_t kind = 0; kind < kNumFeatureKinds; ++kind) {
    if (lists[kind].name != kFeatureKinds[kind].name ||
        lists[kind].dimensions != kFeatureKinds[kind].dimensions) {
      throw std::invalid_argument("list " + std::to_string(kind) + " of the vocabulary must be " +
                                  std::string(kFeatureKinds[kind].name) + " in " +
                                  std::to_string(kFeatureKinds[kind].dimensions) + " dimensions, is " +
                                  lists[kind].name + " in " + std::to_string(lists[kind].dimensions));
    }
  }
}

uint64_t denseFingerprint(const DenseVocabulary& vocabulary) {
  uint64_t hash = hashCombine(vocabulary.fingerprint(), kDenseWordsVersion);
  for (const int setting : {kBlockSize, kBrighter, kMaxCorrected, kPhotometricSettings.level,
                            kPhotometricSettings.power, kPhotometricSettings.max_octaves}) {
    hash = hashCombine(hash, static_cast<uint64_t>(setting));
  }
  return hash;
}

}  // namespace

DenseWords::DenseWords(const DenseVocabulary& vocabulary) : fingerprint_(denseFingerprint(vocabulary)) {
  check(vocabulary);
  int32_t first = 0;
  for (const DenseWordList& list : vocabulary.lists()) {
    searches_.emplace_back(list);
    groups_.push_back({list.name, first, list.numWords()});
    first += list.numWords();
  }
}

world::WordsInCells DenseWords::extract(const world::Observation& observation, const world::Grid& grid) {
  checkObservation(observation);
  const cv::Mat& picture = observation.color;
  if (picture.cols < kBlockSize || picture.rows < kBlockSize) {
    throw std::invalid_argument("images must be at least 8x8 pixels, got " + std::to_string(picture.cols) +
                                "x" + std::to_string(picture.rows));
  }
  correction_.observe(picture);
  const DenseFeatures features = denseFeatures(picture, correction_.responses());
  std::vector<PixelWord> words;
  words.reserve(kNumFeatureKinds * features.numPoints());
  for (size_t kind = 0; kind < kNumFeatureKinds; ++kind) {
    const std::vector<int32_t> nearest = searches_[kind].nearest(features.values[kind]);
    for (size_t point = 0; point < nearest.size(); ++point) {
      const auto i = static_cast<int>(point) % features.columns,
                 j = static_cast<int>(point) / features.columns;
      words.push_back({kBlockSize * i + kBlockSize / 2, kBlockSize * j + kBlockSize / 2,
                       groups_[kind].first + nearest[point]});
    }
  }
  return placeWords(words, observation, grid);
}

std::vector<int64_t> DenseWords::learnt() const {
  const std::array<int64_t, 4> state = correction_.state();
  return {state.begin(), state.end()};
}

void DenseWords::resume(std::span<const int64_t> learnt) {
  std::array<int64_t, 4> state{};
  if (learnt.size() != state.size()) {
    throw std::invalid_argument("a correction has 4 numbers, got " + std::to_string(learnt.size()));
  }
  std::ranges::copy(learnt, state.begin());
  correction_.restore(state);
}

}  // namespace shoal::vision
