// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/photometric_correction.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pictures.h"

namespace shoal::vision {
namespace {

// The gain that the definition gives: level over the sixth root of the mean sixth power, one vote an image.
double gainOf(const std::vector<cv::Mat>& pictures, int channel) {
  double mean_of_means = 0.0;
  for (const cv::Mat& picture : pictures) {
    double mean = 0.0;
    for (int v = 0; v < picture.rows; ++v) {
      for (int u = 0; u < picture.cols; ++u) mean += std::pow(picture.at<cv::Vec3b>(v, u)[channel], 6);
    }
    mean_of_means += mean / static_cast<double>(picture.total()) / static_cast<double>(pictures.size());
  }
  return 150.0 / std::pow(mean_of_means, 1.0 / 6.0);
}

TEST(PhotometricCorrectionTest, ScalesEveryChannelByItsDefinition) {
  PhotometricCorrection correction;
  std::vector<cv::Mat> pictures;
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    pictures.push_back(rectangles({60, 40}, seed) / static_cast<double>(seed));
    correction.observe(pictures.back());
    const ChannelResponses responses = correction.responses();
    for (int c = 0; c < 3; ++c) {
      for (int value = 0; value < 256; ++value) {
        const double expected = std::min(16 * value * gainOf(pictures, c), 8191.0);
        ASSERT_NEAR(responses[static_cast<size_t>(c)][static_cast<size_t>(value)], expected,
                    0.6 + 1e-4 * expected)
            << "channel " << c << ", value " << value << ", " << seed << " images";
      }
    }
  }
}

TEST(PhotometricCorrectionTest, GoesOnFromItsState) {
  PhotometricCorrection seen, resumed;
  seen.observe(cv::Mat(9, 7, CV_8UC3, cv::Scalar(10, 200, 90)));
  resumed.restore(seen.state());
  EXPECT_EQ(resumed.responses(), seen.responses());
  for (PhotometricCorrection* correction : {&seen, &resumed})
    correction->observe(cv::Mat(9, 7, CV_8UC3, cv::Scalar(255, 1, 0)));
  EXPECT_EQ(resumed.responses(), seen.responses());
  EXPECT_EQ(resumed.state(), seen.state());
  for (const std::array<int64_t, 4>& lie :
       {std::array<int64_t, 4>{1, 1, 1, -1}, {-1, 1, 1, 1}, {1, 1, 1, 0}, {1, 1, int64_t{1} << 60, 9}}) {
    EXPECT_THROW(resumed.restore(lie), std::invalid_argument);
  }
  EXPECT_EQ(resumed.state(), seen.state());
}

TEST(PhotometricCorrectionTest, LeavesPicturesAloneBeforeTheFirst) {
  const ChannelResponses responses = PhotometricCorrection().responses();
  for (size_t c = 0; c < 3; ++c) {
    for (size_t value = 0; value < 256; ++value) EXPECT_EQ(responses[c][value], static_cast<int>(16 * value));
  }
}

// Black and white are beyond what gains may do: two octaves.
TEST(PhotometricCorrectionTest, HasGainsOfAtMostTwoOctaves) {
  PhotometricCorrection dark, light;
  dark.observe(cv::Mat(8, 8, CV_8UC3, cv::Scalar::all(0)));
  light.observe(cv::Mat(8, 8, CV_8UC3, cv::Scalar::all(255)));
  EXPECT_EQ(dark.responses()[0][10], 4 * 16 * 10);
  EXPECT_EQ(dark.responses()[0][255], kMaxCorrected);
  EXPECT_NEAR(light.responses()[0][255], 16 * 150, 16);
}

// A brighter camera with a cast: what comes out is the same to within rounding of the camera's own values.
TEST(PhotometricCorrectionTest, TakesOutGainsOfTheCamera) {
  const double gains[3] = {0.8, 1.1, 0.9};
  PhotometricCorrection plain, changed;
  std::vector<cv::Mat> pictures, others;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    pictures.push_back(rectangles({60, 40}, seed) * 0.85);
    cv::Mat other = pictures.back().clone();
    for (int v = 0; v < other.rows; ++v) {
      for (int u = 0; u < other.cols; ++u) {
        for (int c = 0; c < 3; ++c) {
          uint8_t& value = other.at<cv::Vec3b>(v, u)[c];
          value = static_cast<uint8_t>(std::lround(gains[c] * value));
        }
      }
    }
    others.push_back(other);
    plain.observe(pictures.back());
    changed.observe(other);
  }
  const ChannelResponses before = plain.responses(), after = changed.responses();
  for (size_t n = 0; n < pictures.size(); ++n) {
    for (int v = 0; v < pictures[n].rows; ++v) {
      for (int u = 0; u < pictures[n].cols; ++u) {
        for (int c = 0; c < 3; ++c) {
          const auto channel = static_cast<size_t>(c);
          const int expected = before[channel][pictures[n].at<cv::Vec3b>(v, u)[c]];
          ASSERT_NEAR(after[channel][others[n].at<cv::Vec3b>(v, u)[c]], expected, 0.02 * expected + 16)
              << "picture " << n << ", channel " << c;
        }
      }
    }
  }
}

}  // namespace
}  // namespace shoal::vision
