// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/dense_words.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pictures.h"
#include "shoal/vision/dense_features.h"
#include "shoal/vision/shipped_vocabulary.h"

namespace shoal::vision {
namespace {

const world::Grid kGrid(0.8);

bool equal(const world::WordsInCells& a, const world::WordsInCells& b) {
  if (a.dropped_words != b.dropped_words || a.cells.size() != b.cells.size()) return false;
  for (size_t i = 0; i < a.cells.size(); ++i) {
    if (a.cells[i].cell != b.cells[i].cell || a.cells[i].words != b.cells[i].words) return false;
  }
  return true;
}

int64_t numWords(const world::WordsInCells& words) {
  int64_t sum = 0;
  for (const auto& cell : words.cells) {
    for (const auto& word : cell.words) sum += word.count;
  }
  return sum;
}

// Words that both images have in the same cell.
int64_t numShared(const world::WordsInCells& a, const world::WordsInCells& b) {
  std::map<std::pair<world::CellIndex, int32_t>, int32_t> counts;
  for (const auto& cell : a.cells) {
    for (const auto& word : cell.words) counts[{cell.cell, word.word}] = word.count;
  }
  int64_t shared = 0;
  for (const auto& cell : b.cells) {
    for (const auto& word : cell.words) {
      const auto found = counts.find({cell.cell, word.word});
      if (found != counts.end()) shared += std::min(found->second, word.count);
    }
  }
  return shared;
}

// The picture as a camera sees it that multiplies blue, green and red by its own gains.
cv::Mat throughGains(const cv::Mat& picture, const std::array<double, 3>& gains) {
  cv::Mat changed = picture.clone();
  for (int v = 0; v < changed.rows; ++v) {
    for (int u = 0; u < changed.cols; ++u) {
      for (int c = 0; c < 3; ++c) {
        uint8_t& value = changed.at<cv::Vec3b>(v, u)[c];
        value = static_cast<uint8_t>(std::min(255.0, std::round(gains[static_cast<size_t>(c)] * value)));
      }
    }
  }
  return changed;
}

TEST(DenseWordsTest, HaveSevenGroups) {
  const auto extractor = makeWordExtractor("best");
  const std::vector<world::WordGroup> expected{{"lab24", 0, 200},   {"lab8", 200, 200}, {"chr24", 400, 100},
                                               {"tex", 500, 200},   {"hog", 700, 200},  {"lbp", 900, 200},
                                               {"std24", 1100, 100}};
  EXPECT_EQ(extractor->groups(), expected);
  EXPECT_EQ(extractor->vocabularySize(), 1200);
}

// Done again by hand: features, brute-force nearest words, cells by the pinhole from 4 m with fx 200: pixel
// (u, v) lies at X = (u - 159.5) / 50, Y = -(v - 119.5) / 50.
TEST(DenseWordsTest, AreTheNearestWordsAtEveryEighthPixel) {
  const cv::Mat picture = rectangles({320, 240}, 1);
  PhotometricCorrection correction;
  correction.observe(picture);
  const DenseFeatures features = denseFeatures(picture, correction.responses());
  const DenseVocabulary vocabulary = DenseVocabulary::parse(shippedDenseVocabulary());
  std::map<world::CellIndex, std::map<int32_t, int32_t>> expected;
  int32_t first = 0;
  for (size_t kind = 0; kind < kNumFeatureKinds; ++kind) {
    const DenseWordList& list = vocabulary.lists()[kind];
    const auto dimensions = static_cast<size_t>(list.dimensions);
    for (int j = 0; j < 30; ++j) {
      for (int i = 0; i < 40; ++i) {
        const auto point = static_cast<size_t>(40 * j + i) * dimensions;
        int64_t least = std::numeric_limits<int64_t>::max();
        int32_t nearest = 0;
        for (int32_t word = 0; word < list.numWords(); ++word) {
          int64_t distance = 0;
          for (size_t d = 0; d < dimensions; ++d) {
            const int64_t difference =
                features.values[kind][point + d] - list.words[static_cast<size_t>(word) * dimensions + d];
            distance += difference * difference;
          }
          if (distance < least) {
            least = distance;
            nearest = word;
          }
        }
        ++expected[kGrid.cellOf({(8 * i + 4 - 159.5) / 50, -(8 * j + 4 - 119.5) / 50, 0.0})][first + nearest];
      }
    }
    first += list.numWords();
  }

  const auto words = makeWordExtractor("best")->extract(seenFromAbove(picture, 4.0), kGrid);
  EXPECT_EQ(words.observation, 7);
  EXPECT_EQ(words.dropped_words, 0);
  ASSERT_EQ(words.cells.size(), expected.size());
  size_t c = 0;
  for (const auto& [cell, counts] : expected) {
    EXPECT_EQ(words.cells[c].cell, cell);
    std::vector<world::WordCount> of_cell;
    for (const auto& [word, count] : counts) of_cell.push_back({word, count});
    EXPECT_EQ(words.cells[c++].words, of_cell);
  }
}

// Depth is missing in the left half: its 20 columns of points lose all seven words.
TEST(DenseWordsTest, DropAndCountWordsWithoutDepth) {
  for (const float none : {0.0f, -2.0f, std::numeric_limits<float>::quiet_NaN()}) {
    auto observation = seenFromAbove(rectangles({320, 240}, 1), 4.0);
    observation.depth_m.colRange(0, 160).setTo(none);
    const auto words = makeWordExtractor("best")->extract(observation, kGrid);
    EXPECT_EQ(words.dropped_words, 7 * 20 * 30) << none;
    EXPECT_EQ(numWords(words), 7 * 20 * 30) << none;
  }
}

// Own brightness and cast cost few words: what is left is rounding to 8 bits before the correction.

TEST(DenseWordsTest, HardlyDependOnTheBrightnessAndCastOfTheCamera) {
  const std::array<double, 3> gains{0.9, 0.7, 0.65};
  const auto plain = makeWordExtractor("best"), changed = makeWordExtractor("best");
  int64_t all = 0, shared = 0;
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const cv::Mat picture = rectangles({320, 240}, seed);
    const auto words = plain->extract(seenFromAbove(picture, 4.0), kGrid);
    const cv::Mat seen = throughGains(picture, gains);
    shared += numShared(words, changed->extract(seenFromAbove(seen, 4.0), kGrid));
    all += numWords(words);
  }
  EXPECT_GT(shared, 0.9 * static_cast<double>(all)) << shared << " of " << all;
}

// The correction counts the images so far, in this object only.
TEST(DenseWordsTest, AreAFunctionOfTheImagesSoFar) {
  const auto first = seenFromAbove(rectangles({320, 240}, 1) * 0.4, 4.0);
  const auto second = seenFromAbove(rectangles({320, 240}, 2), 4.0);
  const auto extractor = makeWordExtractor("best"), again = makeWordExtractor("best");
  extractor->extract(first, kGrid);
  again->extract(first, kGrid);
  const auto words = extractor->extract(second, kGrid);
  EXPECT_TRUE(equal(words, again->extract(second, kGrid)));
  EXPECT_FALSE(equal(words, makeWordExtractor("best")->extract(second, kGrid)));
}

TEST(DenseWordsTest, AreTheSameWithAnyNumberOfThreads) {
  const auto observation = seenFromAbove(rectangles({320, 240}, 4), 4.0);
  const int threads = cv::getNumThreads();
  const auto once = makeWordExtractor("best")->extract(observation, kGrid);
  for (const int n : {1, 2, 5}) {
    cv::setNumThreads(n);
    EXPECT_TRUE(equal(makeWordExtractor("best")->extract(observation, kGrid), once)) << n;
  }
  cv::setNumThreads(threads);
}

// An observation that is refused leaves the correction as it was.
TEST(DenseWordsTest, RefuseImagesThatDoNotFit) {
  const auto extractor = makeWordExtractor("best");
  EXPECT_THROW(extractor->extract({}, kGrid), std::invalid_argument);
  auto bad = seenFromAbove(rectangles({320, 240}, 6), 4.0);
  bad.depth_m = bad.depth_m.colRange(0, 300);
  EXPECT_THROW(extractor->extract(bad, kGrid), std::invalid_argument);
  EXPECT_THROW(extractor->extract(seenFromAbove(rectangles({7, 240}, 6), 4.0), kGrid), std::invalid_argument);
  EXPECT_THROW(extractor->extract(seenFromAbove(rectangles({320, 7}, 6), 4.0), kGrid), std::invalid_argument);
  const auto good = seenFromAbove(rectangles({320, 240}, 7), 4.0);
  EXPECT_TRUE(equal(extractor->extract(good, kGrid), makeWordExtractor("best")->extract(good, kGrid)));
}

TEST(DenseWordsTest, TakeTheSmallestPicture) {
  const auto words = makeWordExtractor("best")->extract(seenFromAbove(rectangles({15, 8}, 7), 4.0), kGrid);
  EXPECT_EQ(numWords(words), 7);
}

TEST(DenseWordsTest, TakeOnlyAVocabularyOfTheirKinds) {
  std::vector<DenseWordList> lists = DenseVocabulary::parse(shippedDenseVocabulary()).lists();
  lists[4].words.resize(16 * 5);  // fewer words are fine
  const auto bytes = DenseVocabulary(lists).serialize();
  EXPECT_EQ(makeWordExtractor("best", bytes)->vocabularySize(), 1005);
  EXPECT_NE(makeWordExtractor("best", bytes)->fingerprint(), makeWordExtractor("best")->fingerprint());
  EXPECT_THROW(makeWordExtractor("best", shippedOrbVocabulary()), std::invalid_argument);
  EXPECT_THROW(makeWordExtractor("best", std::span(bytes).first(bytes.size() - 1)), std::invalid_argument);
  std::swap(lists[0], lists[1]);
  EXPECT_THROW(DenseWords(DenseVocabulary(lists)), std::invalid_argument);
  lists.pop_back();
  EXPECT_THROW(DenseWords(DenseVocabulary(lists)), std::invalid_argument);
}

}  // namespace
}  // namespace shoal::vision
