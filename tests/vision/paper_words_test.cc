// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/paper_words.h"

#include <array>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "pictures.h"
#include "shoal/vision/shipped_vocabulary.h"

namespace shoal::vision {
namespace {

const world::Grid kGrid(0.8);

void expectEqual(const world::WordsInCells& a, const world::WordsInCells& b) {
  EXPECT_EQ(a.dropped_words, b.dropped_words);
  ASSERT_EQ(a.cells.size(), b.cells.size());
  for (size_t i = 0; i < a.cells.size(); ++i) {
    EXPECT_EQ(a.cells[i].cell, b.cells[i].cell);
    EXPECT_EQ(a.cells[i].words, b.cells[i].words);
  }
}

// Words placed, by group.
std::vector<int64_t> countByGroup(const WordExtractor& extractor, const world::WordsInCells& words) {
  std::vector<int64_t> counts(extractor.groups().size(), 0);
  for (const auto& cell : words.cells) {
    for (const auto& [word, count] : cell.words) {
      for (size_t g = 0; g < counts.size(); ++g) {
        const auto& group = extractor.groups()[g];
        if (word >= group.first && word < group.first + group.size) counts[g] += count;
      }
    }
  }
  return counts;
}

TEST(PaperWordsTest, HaveTheGroupsOfThePaper) {
  const auto extractor = makeWordExtractor("paper");
  const std::vector<world::WordGroup> expected{{"orb_l", 0, 5000},
                                               {"orb_a", 5000, 5000},
                                               {"orb_b", 10000, 5000},
                                               {"hue", 15000, 180},
                                               {"intensity", 15180, 256}};
  EXPECT_EQ(extractor->groups(), expected);
  EXPECT_EQ(extractor->vocabularySize(), 15436);
}

// A plain picture has no corners: what remains are its 2 x 32 x 24 colour words, each in the cell that the
// block's middle falls into. From 4 m with fx 200 that middle, pixel (10 i + 5, 10 j + 5), lies at X = (10 i
// - 154.5) / 50, Y = -(10 j - 114.5) / 50.
TEST(PaperWordsTest, PutEveryColourWordIntoTheComputedCell) {
  const auto observation = seenFromAbove(cv::Mat(240, 320, CV_8UC3, cv::Scalar(40, 90, 160)), 4.0);
  const auto words = makeWordExtractor("paper")->extract(observation, kGrid);

  std::map<world::CellIndex, int32_t> blocks;
  for (int j = 0; j < 24; ++j) {
    for (int i = 0; i < 32; ++i) ++blocks[kGrid.cellOf({(10 * i - 154.5) / 50, -(10 * j - 114.5) / 50, 0.0})];
  }
  EXPECT_EQ(words.dropped_words, 0);
  ASSERT_EQ(words.cells.size(), blocks.size());
  size_t c = 0;
  for (const auto& [cell, count] : blocks) {
    EXPECT_EQ(words.cells[c].cell, cell);
    ASSERT_EQ(words.cells[c].words.size(), 2u);  // one hue and one intensity, for the picture is plain
    EXPECT_EQ(words.cells[c].words[0].count, count);
    EXPECT_EQ(words.cells[c++].words[1].count, count);
  }
}

// Depth is missing in the left half: its 16 columns of blocks lose both their words.
TEST(PaperWordsTest, DropAndCountWordsWithoutDepth) {
  for (const float none : {0.0f, -2.0f, std::numeric_limits<float>::quiet_NaN()}) {
    auto observation = seenFromAbove(cv::Mat(240, 320, CV_8UC3, cv::Scalar(40, 90, 160)), 4.0);
    observation.depth_m.colRange(0, 160).setTo(none);
    const auto extractor = makeWordExtractor("paper");
    const auto words = extractor->extract(observation, kGrid);
    EXPECT_EQ(words.dropped_words, 2 * 16 * 24) << none;
    EXPECT_EQ(countByGroup(*extractor, words), (std::vector<int64_t>{0, 0, 0, 16 * 24, 16 * 24})) << none;
  }
}

TEST(PaperWordsTest, AreNothingButDroppedWhenAllDepthIsMissing) {
  auto observation = seenFromAbove(rectangles({320, 240}, 1), 4.0);
  observation.depth_m.setTo(0.0f);
  const auto words = makeWordExtractor("paper")->extract(observation, kGrid);
  EXPECT_TRUE(words.cells.empty());
  EXPECT_GT(words.dropped_words, 1536);
}

// Done again with nothing but OpenCV: equalise, find, match by brute force.
TEST(PaperWordsTest, AgreeWithOpenCvStepByStep) {
  const cv::Mat picture = rectangles({320, 240}, 2);
  cv::Mat lab, lightness;
  cv::cvtColor(picture, lab, cv::COLOR_BGR2Lab);
  std::array<cv::Mat, 3> channels;
  cv::split(lab, channels.data());
  cv::createCLAHE(4.0, {8, 8})->apply(channels[0], lightness);
  channels[0] = lightness;
  const auto vocabulary = shippedOrbVocabulary();
  const cv::Mat dictionary(5000, 32, CV_8U, const_cast<uint8_t*>(vocabulary.data() + 24));

  std::map<int32_t, int32_t> expected;
  for (int channel = 0; channel < 3; ++channel) {
    std::vector<cv::KeyPoint> points;
    cv::Mat descriptors;
    cv::ORB::create(1000)->detectAndCompute(channels[static_cast<size_t>(channel)], cv::noArray(), points,
                                            descriptors);
    std::vector<cv::DMatch> matches;
    cv::BFMatcher(cv::NORM_HAMMING).match(descriptors, dictionary, matches);
    EXPECT_FALSE(matches.empty()) << "no corners in channel " << channel;
    for (const cv::DMatch& match : matches) ++expected[5000 * channel + match.trainIdx];
  }

  const auto words = makeWordExtractor("paper")->extract(seenFromAbove(picture, 4.0), kGrid);
  std::map<int32_t, int32_t> found;
  for (const auto& cell : words.cells) {
    for (const auto& [word, count] : cell.words) {
      if (word < 15000) found[word] += count;
    }
  }
  EXPECT_EQ(found, expected);
}

TEST(PaperWordsTest, AreSortedAndInRange) {
  const auto extractor = makeWordExtractor("paper");
  const auto words = extractor->extract(seenFromAbove(rectangles({320, 240}, 3), 4.0), kGrid);
  ASSERT_FALSE(words.cells.empty());
  for (size_t c = 0; c < words.cells.size(); ++c) {
    if (c > 0) {
      EXPECT_LT(words.cells[c - 1].cell, words.cells[c].cell);
    }
    const auto& counts = words.cells[c].words;
    ASSERT_FALSE(counts.empty());
    for (size_t i = 0; i < counts.size(); ++i) {
      if (i > 0) {
        EXPECT_LT(counts[i - 1].word, counts[i].word);
      }
      EXPECT_GT(counts[i].count, 0);
      EXPECT_GE(counts[i].word, 0);
      EXPECT_LT(counts[i].word, extractor->vocabularySize());
    }
  }
}

TEST(PaperWordsTest, AreTheSameEveryTimeWithAnyNumberOfThreads) {
  const auto observation = seenFromAbove(rectangles({320, 240}, 4), 4.0);
  const int threads = cv::getNumThreads();
  const auto once = makeWordExtractor("paper")->extract(observation, kGrid);
  for (const int n : {1, 2, 5}) {
    cv::setNumThreads(n);
    const auto again = makeWordExtractor("paper")->extract(observation, kGrid);
    EXPECT_EQ(cv::getNumThreads(), n);  // extraction leaves the process as it was
    expectEqual(again, once);
  }
  cv::setNumThreads(threads);
}

TEST(PaperWordsTest, LeaveTheImagesAlone) {
  const cv::Mat picture = rectangles({320, 240}, 5);
  const auto observation = seenFromAbove(picture.clone(), 4.0);
  makeWordExtractor("paper")->extract(observation, kGrid);
  EXPECT_EQ(cv::norm(observation.color, picture, cv::NORM_INF), 0.0);
}

TEST(PaperWordsTest, RefuseImagesThatDoNotFit) {
  const auto extractor = makeWordExtractor("paper");
  EXPECT_THROW(extractor->extract({}, kGrid), std::invalid_argument);
  auto observation = seenFromAbove(rectangles({320, 240}, 6), 4.0);
  observation.depth_m = observation.depth_m.colRange(0, 300);
  EXPECT_THROW(extractor->extract(observation, kGrid), std::invalid_argument);
  EXPECT_THROW(extractor->extract(seenFromAbove(rectangles({31, 240}, 6), 4.0), kGrid),
               std::invalid_argument);
  EXPECT_THROW(extractor->extract(seenFromAbove(rectangles({320, 31}, 6), 4.0), kGrid),
               std::invalid_argument);
}

// The smallest picture is too small for ORB, and still has its colours.
TEST(PaperWordsTest, TakeTheSmallestPicture) {
  const auto extractor = makeWordExtractor("paper");
  const auto words = extractor->extract(seenFromAbove(rectangles({32, 32}, 7), 4.0), kGrid);
  EXPECT_EQ(countByGroup(*extractor, words), (std::vector<int64_t>{0, 0, 0, 1024, 1024}));
}

TEST(MakeWordExtractorTest, RefusesProfilesByName) {
  const auto complaint = [](const std::string& profile) -> std::string {
    try {
      makeWordExtractor(profile);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "no complaint";
  };
  EXPECT_EQ(complaint("foo"), "no profile \"foo\"; use \"paper\" or \"best\"");
  EXPECT_EQ(complaint(""), "no profile \"\"; use \"paper\" or \"best\"");
  EXPECT_EQ(complaint("best"), "no complaint");
  EXPECT_EQ(complaint("paper"), "no complaint");
}

TEST(MakeWordExtractorTest, TakesAVocabularyOfTheCallers) {
  const auto bytes = Vocabulary({{1, 2, 3, 4}, {5, 6, 7, 8}}).serialize();
  const auto extractor = makeWordExtractor("paper", bytes);
  EXPECT_EQ(extractor->vocabularySize(), 3 * 2 + 180 + 256);
  const auto other_words = Vocabulary({{1, 2, 3, 4}, {5, 6, 7, 9}}).serialize();
  EXPECT_NE(extractor->fingerprint(), makeWordExtractor("paper", other_words)->fingerprint());
  EXPECT_THROW(makeWordExtractor("paper", std::span(bytes).first(40)), std::invalid_argument);
}

TEST(MakeWordExtractorTest, HasAFingerprintOfVocabularyAndParameters) {
  EXPECT_EQ(makeWordExtractor("paper")->fingerprint(), makeWordExtractor("paper")->fingerprint());
  EXPECT_NE(makeWordExtractor("paper")->fingerprint(),
            Vocabulary::parse(shippedOrbVocabulary()).fingerprint());
}

}  // namespace
}  // namespace shoal::vision
