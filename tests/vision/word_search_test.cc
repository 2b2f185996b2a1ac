// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/word_search.h"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/features2d.hpp>

#include "shoal/random.h"

namespace shoal::vision {
namespace {

// Only `bits` random bits of a word vary, so that few bits make many ties.
std::vector<BinaryWord> randomWords(size_t count, int bits, uint64_t seed) {
  Random random(seed);
  std::vector<BinaryWord> words(count, BinaryWord{});
  for (BinaryWord& word : words) {
    for (int i = 0; i < bits; ++i) word[static_cast<size_t>(i % 4)] |= (random() & 1) << (i / 4 * 16 % 61);
  }
  return words;
}

std::vector<BinaryWord> denseWords(size_t count, uint64_t seed) {
  Random random(seed);
  std::vector<BinaryWord> words(count);
  for (BinaryWord& word : words) {
    for (uint64_t& part : word) part = random();
  }
  return words;
}

// From the definition: bit by bit, the first least distance.
int32_t bruteForce(const BinaryWord& descriptor, const std::vector<BinaryWord>& words) {
  int best = 257;
  int32_t best_word = -1;
  for (size_t k = 0; k < words.size(); ++k) {
    int distance = 0;
    for (size_t bit = 0; bit < 256; ++bit) {
      distance += ((descriptor[bit / 64] >> (bit % 64)) & 1) != ((words[k][bit / 64] >> (bit % 64)) & 1);
    }
    if (distance < best) {
      best = distance;
      best_word = static_cast<int32_t>(k);
    }
  }
  return best_word;
}

cv::Mat toMat(const std::vector<BinaryWord>& words) {
  cv::Mat bytes(static_cast<int>(words.size()), 32, CV_8U);
  for (int i = 0; i < bytes.rows; ++i) {
    for (int b = 0; b < 32; ++b) {
      bytes.at<uint8_t>(i, b) =
          static_cast<uint8_t>(words[static_cast<size_t>(i)][static_cast<size_t>(b / 8)] >> (8 * (b % 8)));
    }
  }
  return bytes;
}

class WordSearchTest : public testing::TestWithParam<SearchPath> {};

TEST_P(WordSearchTest, AgreesWithBruteForceForEveryNumberOfWords) {
  for (size_t num_words = 1; num_words <= 19; ++num_words) {
    for (const int bits : {3, 8, 16}) {
      const auto words = randomWords(num_words, bits, num_words);
      const auto descriptors = randomWords(40, bits, 100 + num_words);
      const auto nearest = WordSearch(words, GetParam()).nearest(descriptors);
      ASSERT_EQ(nearest.size(), descriptors.size());
      for (size_t i = 0; i < descriptors.size(); ++i) {
        ASSERT_EQ(nearest[i], bruteForce(descriptors[i], words)) << num_words << " words, descriptor " << i;
      }
    }
  }
}

TEST_P(WordSearchTest, AgreesWithBruteForceOnDenseWords) {
  const auto words = denseWords(203, 1);
  const auto descriptors = denseWords(100, 2);
  const auto nearest = WordSearch(words, GetParam()).nearest(descriptors);
  for (size_t i = 0; i < descriptors.size(); ++i)
    ASSERT_EQ(nearest[i], bruteForce(descriptors[i], words)) << i;
}

TEST_P(WordSearchTest, AgreesWithOpenCvsMatcher) {
  const auto words = denseWords(1000, 3);
  const auto descriptors = denseWords(200, 4);
  std::vector<cv::DMatch> matches;
  cv::BFMatcher(cv::NORM_HAMMING).match(toMat(descriptors), toMat(words), matches);
  const auto nearest = WordSearch(words, GetParam()).nearest(descriptors);
  ASSERT_EQ(matches.size(), nearest.size());
  for (size_t i = 0; i < nearest.size(); ++i) {
    EXPECT_EQ(hammingDistance(descriptors[i], words[static_cast<size_t>(nearest[i])]), matches[i].distance)
        << i;
    EXPECT_EQ(nearest[i], matches[i].trainIdx) << i;
  }
}

// With 8 bits and 300 words every distance comes many times.
TEST_P(WordSearchTest, GivesTiesToTheLowestIndexAsOpenCvDoes) {
  const auto words = randomWords(300, 8, 5);
  const auto descriptors = randomWords(200, 12, 6);
  std::vector<cv::DMatch> matches;
  cv::BFMatcher(cv::NORM_HAMMING).match(toMat(descriptors), toMat(words), matches);
  const auto nearest = WordSearch(words, GetParam()).nearest(descriptors);
  for (size_t i = 0; i < nearest.size(); ++i) {
    ASSERT_EQ(nearest[i], bruteForce(descriptors[i], words)) << i;
    ASSERT_EQ(nearest[i], matches[i].trainIdx) << i;
  }
}

// The least and the largest distance, 0 and 256, and equal words.
TEST_P(WordSearchTest, HoldsAtTheEndsOfTheRange) {
  const BinaryWord zeros{};
  const BinaryWord ones{~0ull, ~0ull, ~0ull, ~0ull};
  EXPECT_EQ(WordSearch({ones}, GetParam()).nearest({{zeros}}), std::vector<int32_t>{0});
  EXPECT_EQ(WordSearch({ones, zeros}, GetParam()).nearest({{zeros, ones}}), (std::vector<int32_t>{1, 0}));
  const std::vector<BinaryWord> equal(11, ones);
  EXPECT_EQ(WordSearch(equal, GetParam()).nearest({{zeros, ones}}), (std::vector<int32_t>{0, 0}));
}

TEST_P(WordSearchTest, FindsNothingForNothing) {
  EXPECT_TRUE(WordSearch(denseWords(5, 7), GetParam()).nearest({}).empty());
}

std::string pathName(const testing::TestParamInfo<SearchPath>& path) {
  return std::vector<std::string>{"Portable", "Popcnt", "Avx2"}.at(static_cast<size_t>(path.param));
}

INSTANTIATE_TEST_SUITE_P(Paths, WordSearchTest, testing::ValuesIn(availableSearchPaths()), pathName);

TEST(WordSearchSetUpTest, NeedsAWord) { EXPECT_THROW(WordSearch({}), std::invalid_argument); }

}  // namespace
}  // namespace shoal::vision
