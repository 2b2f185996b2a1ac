// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/color_words.h"

#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace shoal::vision {
namespace {

// Pure red has hue 0, green 60, blue 120 (two degrees a step) and V 255.
TEST(ColorWordsTest, NamesHueAndIntensityOfPlainColours) {
  const auto words = [](const cv::Scalar& bgr) {
    return colorWords(cv::Mat(24, 32, CV_8UC3, bgr), 1000, 2000);
  };
  EXPECT_EQ(words({0, 0, 255})[0].word, 1000);
  EXPECT_EQ(words({0, 255, 0})[0].word, 1060);
  EXPECT_EQ(words({255, 0, 0})[0].word, 1120);
  EXPECT_EQ(words({255, 0, 0})[1].word, 2255);
  EXPECT_EQ(words({10, 77, 20})[1].word, 2077);
}

// 320x240: blocks of 10x10, middles at 5, 15, ...
TEST(ColorWordsTest, StandAtTheMiddleOfTheirBlocks) {
  const auto words = colorWords(cv::Mat(240, 320, CV_8UC3, cv::Scalar(0, 0, 50)), 0, 180);
  ASSERT_EQ(words.size(), 1536u);
  for (int j = 0; j < 24; ++j) {
    for (int i = 0; i < 32; ++i) {
      const auto at = static_cast<size_t>(2 * (j * 32 + i));
      EXPECT_EQ(words[at], (PixelWord{10 * i + 5, 10 * j + 5, 0}));
      EXPECT_EQ(words[at + 1], (PixelWord{10 * i + 5, 10 * j + 5, 230}));
    }
  }
}

// A block of 2x2 pixels whose V is 10, 20, 30 and 40 has the mean, 25.
TEST(ColorWordsTest, AverageTheirBlock) {
  cv::Mat picture(48, 64, CV_8UC3, cv::Scalar(0, 0, 0));
  picture.at<cv::Vec3b>(2, 4) = {10, 10, 10};
  picture.at<cv::Vec3b>(2, 5) = {20, 20, 20};
  picture.at<cv::Vec3b>(3, 4) = {30, 30, 30};
  picture.at<cv::Vec3b>(3, 5) = {40, 40, 40};
  const auto words = colorWords(picture, 0, 180);
  EXPECT_EQ(words[2 * (1 * 32 + 2) + 1], (PixelWord{5, 3, 180 + 25}));
}

TEST(ColorWordsTest, KeepOneRowOfAVeryWidePicture) {
  EXPECT_EQ(colorWords(cv::Mat(2, 640, CV_8UC3, cv::Scalar(1, 2, 3)), 0, 180).size(), 64u);
}

// Every middle lies inside its block and the picture, whatever the size.
TEST(ColorWordsTest, StayInsideThePicture) {
  for (const cv::Size size : {cv::Size(32, 32), cv::Size(33, 47), cv::Size(101, 35), cv::Size(319, 241)}) {
    for (const PixelWord& word : colorWords(cv::Mat(size, CV_8UC3, cv::Scalar(9, 8, 7)), 0, 180)) {
      EXPECT_TRUE(word.u >= 0 && word.u < size.width && word.v >= 0 && word.v < size.height) << size;
    }
  }
}

}  // namespace
}  // namespace shoal::vision
