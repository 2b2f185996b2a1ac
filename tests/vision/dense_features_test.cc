// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/dense_features.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pictures.h"
#include "shoal/vision/fixed_math.h"
#include "shoal/vision/perceived_color.h"

namespace shoal::vision {
namespace {

ChannelResponses responsesTo(const cv::Mat& picture) {
  PhotometricCorrection correction;
  correction.observe(picture);
  return correction.responses();
}

// Every number of a feature from its definition, pixel by pixel, one point at a time.
class BruteForce {
 public:
  BruteForce(const cv::Mat& picture, const ChannelResponses& responses)
      : picture_(picture),
        responses_(responses),
        width_(picture.cols / 8 * 8),
        height_(picture.rows / 8 * 8) {}

  // Pixels [first, last) of a window of a level, cut at the edge.
  struct Window {
    int first_u, last_u, first_v, last_v;
    double pixels() const { return double{1} * (last_u - first_u) * (last_v - first_v); }
  };
  Window window(int i, int j, int level, int margin = 1) const {
    const int size = 8 >> level;
    return {std::max(i - margin, 0) * size, std::min((i + margin + 1) * size, width_ >> level),
            std::max(j - margin, 0) * size, std::min((j + margin + 1) * size, height_ >> level)};
  }

  template <typename Value>
  static double sum(const Window& window, Value&& value) {
    double total = 0;
    for (int v = window.first_v; v < window.last_v; ++v) {
      for (int u = window.first_u; u < window.last_u; ++u) total += static_cast<double>(value(u, v));
    }
    return total;
  }

  int corrected(int u, int v, int channel) const {
    return responses_[static_cast<size_t>(channel)][picture_.at<cv::Vec3b>(v, u)[channel]];
  }

  std::array<int, 3> lab(int u, int v) const {
    const PerceivedColor color = perceivedColor(
        linearLight(corrected(u, v, 0)), linearLight(corrected(u, v, 1)), linearLight(corrected(u, v, 2)));
    return {color.lightness, color.a, color.b};
  }

  int image(int u, int v, int level) const {
    u = std::clamp(u, 0, (width_ >> level) - 1);
    v = std::clamp(v, 0, (height_ >> level) - 1);
    if (level == 0) {
      const int y = (54 * corrected(u, v, 2) + 183 * corrected(u, v, 1) + 19 * corrected(u, v, 0)) / 256;
      return fixedLog2(static_cast<uint64_t>(y + 128), 10);
    }
    return (image(2 * u, 2 * v, level - 1) + image(2 * u + 1, 2 * v, level - 1) +
            image(2 * u, 2 * v + 1, level - 1) + image(2 * u + 1, 2 * v + 1, level - 1) + 2) /
           4;
  }

  int smooth(int u, int v, int level) const {
    u = std::clamp(u, 0, (width_ >> level) - 1);
    v = std::clamp(v, 0, (height_ >> level) - 1);
    int sum = 8;
    for (int dv = -1; dv <= 1; ++dv) {
      for (int du = -1; du <= 1; ++du)
        sum += (2 - std::abs(du)) * (2 - std::abs(dv)) * image(u + du, v + dv, level);
    }
    return sum / 16;
  }

  int gx(int u, int v, int level) const { return smooth(u + 1, v, level) - smooth(u - 1, v, level); }
  int gy(int u, int v, int level) const { return smooth(u, v + 1, level) - smooth(u, v - 1, level); }
  int blob(int u, int v, int level) const {
    return 4 * smooth(u, v, level) - smooth(u - 1, v, level) - smooth(u + 1, v, level) -
           smooth(u, v - 1, level) - smooth(u, v + 1, level);
  }

  int pattern(int u, int v, int level) const {
    constexpr int kRing[8][2] = {{-1, -1}, {0, -1}, {1, -1}, {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}};
    std::array<bool, 8> brighter{};
    for (size_t n = 0; n < 8; ++n) {
      brighter[n] = image(u + kRing[n][0], v + kRing[n][1], level) - image(u, v, level) >= 16;
    }
    int changes = 0;
    for (size_t n = 0; n < 8; ++n) changes += brighter[n] != brighter[(n + 1) % 8];
    return changes > 2 ? 9 : static_cast<int>(std::count(brighter.begin(), brighter.end(), true));
  }

 private:
  const cv::Mat& picture_;
  const ChannelResponses& responses_;
  int width_, height_;
};

double logOf(double x, int bits) { return std::floor(std::log2(x) * (1 << bits) + 1e-6); }

class DenseFeaturesTest : public testing::Test {
 protected:
  // Calls check(i, j, values of the kind at the point) at every point.
  template <typename Check>
  void forEachPoint(FeatureKindIndex kind, Check&& check) const {
    const auto dimensions = static_cast<size_t>(kFeatureKinds[kind].dimensions);
    ASSERT_EQ(features_.values[kind].size(), features_.numPoints() * dimensions);
    for (int j = 0; j < features_.rows; ++j) {
      for (int i = 0; i < features_.columns; ++i) {
        SCOPED_TRACE("point " + std::to_string(i) + ", " + std::to_string(j));
        const auto point = static_cast<size_t>(j * features_.columns + i);
        check(i, j, std::span(features_.values[kind]).subspan(point * dimensions, dimensions));
      }
    }
  }

  // 7 x 5 blocks and some pixels to leave out.
  const cv::Mat picture_ = rectangles({61, 43}, 11);
  const ChannelResponses responses_ = responsesTo(picture_);
  const DenseFeatures features_ = denseFeatures(picture_, responses_);
  const BruteForce brute_{picture_, responses_};
};

TEST_F(DenseFeaturesTest, HaveAPointABlock) {
  EXPECT_EQ(features_.columns, 7);
  EXPECT_EQ(features_.rows, 5);
  EXPECT_EQ(features_.numPoints(), 35u);
}

TEST_F(DenseFeaturesTest, MeanColoursAreMeansOverTheWindow) {
  for (const auto& [kind, margin] : {std::pair{kLab24, 1}, std::pair{kLab8, 0}}) {
    forEachPoint(kind, [&](int i, int j, std::span<const int16_t> values) {
      const auto window = brute_.window(i, j, 0, margin);
      for (size_t c = 0; c < 3; ++c) {
        const double mean =
            BruteForce::sum(window, [&](int u, int v) { return brute_.lab(u, v)[c]; }) / window.pixels();
        EXPECT_EQ(values[c], std::floor(mean + 0.5));
      }
    });
  }
}

TEST_F(DenseFeaturesTest, ChromaticitiesAreLogRatiosOfMeans) {
  forEachPoint(kChr24, [&](int i, int j, std::span<const int16_t> values) {
    const auto window = brute_.window(i, j, 0);
    const auto sum = [&](int channel) {
      return BruteForce::sum(window, [&](int u, int v) { return brute_.corrected(u, v, channel) + 32; });
    };
    EXPECT_NEAR(values[0], 1024 * std::log2(sum(2) / sum(1)), 1.1);
    EXPECT_NEAR(values[1], 1024 * std::log2(sum(0) / sum(1)), 1.1);
  });
}

TEST_F(DenseFeaturesTest, DeviationsAreLogsOfVariances) {
  forEachPoint(kStd24, [&](int i, int j, std::span<const int16_t> values) {
    const auto window = brute_.window(i, j, 0);
    for (size_t c = 0; c < 3; ++c) {
      const auto value = [&](int u, int v) { return brute_.lab(u, v)[c]; };
      const double mean = BruteForce::sum(window, value) / window.pixels();
      const double variance =
          BruteForce::sum(window, [&](int u, int v) { return std::pow(value(u, v) - mean, 2); }) /
          window.pixels();
      EXPECT_EQ(values[c], logOf(std::floor(variance + 1e-6) + 16, 7));
    }
  });
}

TEST_F(DenseFeaturesTest, TexturesAreLogsOfEnergiesAndCoherence) {
  forEachPoint(kTex, [&](int i, int j, std::span<const int16_t> values) {
    for (int level = 0; level < 3; ++level) {
      SCOPED_TRACE("level " + std::to_string(level));
      const auto window = brute_.window(i, j, level);
      const auto mean = [&](auto&& value) {
        return std::floor(BruteForce::sum(window, value) / window.pixels());
      };
      const auto blob = [&](int u, int v) { return std::pow(brute_.blob(u, v, level), 2); };
      const auto edge = [&](int u, int v) {
        return std::pow(brute_.gx(u, v, level), 2) + std::pow(brute_.gy(u, v, level), 2);
      };
      const auto l = static_cast<size_t>(level);
      EXPECT_EQ(values[l], logOf(mean(blob) + 64, 7));
      EXPECT_EQ(values[3 + l], logOf(mean(edge) + 64, 7));
      if (level == 2) break;
      const double xx = mean([&](int u, int v) { return std::pow(brute_.gx(u, v, level), 2); });
      const double yy = mean([&](int u, int v) { return std::pow(brute_.gy(u, v, level), 2); });
      const double xy = mean([&](int u, int v) { return brute_.gx(u, v, level) * brute_.gy(u, v, level); });
      EXPECT_NEAR(values[6 + l], 1024 * std::hypot(xx - yy, 2 * xy) / (xx + yy + 64), 2);
    }
  });
}

// A direction is told by integer comparison, which may differ from the arc tangent just at a border.
TEST_F(DenseFeaturesTest, DirectionsAreSharesOfEdgeStrengthFromTheStrongestOn) {
  constexpr double kDegrees = 180 / 3.14159265358979;
  forEachPoint(kHog, [&](int i, int j, std::span<const int16_t> values) {
    for (int level = 0; level < 2; ++level) {
      const auto window = brute_.window(i, j, level);
      std::vector<double> strengths(8, 0);
      double whole = 8 * window.pixels();
      for (int v = window.first_v; v < window.last_v; ++v) {
        for (int u = window.first_u; u < window.last_u; ++u) {
          const int gx = brute_.gx(u, v, level), gy = brute_.gy(u, v, level);
          const double turn = std::atan2(gy, gx) * kDegrees / 22.5;
          const int strength =
              std::max(std::abs(gx), std::abs(gy)) + 3 * std::min(std::abs(gx), std::abs(gy)) / 8;
          strengths[static_cast<size_t>(std::lround(turn + 8)) % 8] += strength;
          whole += strength;
        }
      }
      std::rotate(strengths.begin(), std::max_element(strengths.begin(), strengths.end()), strengths.end());
      for (size_t n = 0; n < 8; ++n) {
        EXPECT_NEAR(values[static_cast<size_t>(8 * level) + n], 1024 * std::sqrt(strengths[n] / whole), 20)
            << "level " << level << ", direction " << n;
      }
    }
  });
}

TEST_F(DenseFeaturesTest, PatternsAreShares) {
  forEachPoint(kLbp, [&](int i, int j, std::span<const int16_t> values) {
    for (int level = 0; level < 3; ++level) {
      const auto window = brute_.window(i, j, level);
      for (int n = 0; n < 10; ++n) {
        const double count =
            BruteForce::sum(window, [&](int u, int v) { return brute_.pattern(u, v, level) == n; });
        EXPECT_EQ(values[static_cast<size_t>(10 * level + n)],
                  std::floor(1024 * std::sqrt(count / window.pixels()) + 1e-6))
            << "level " << level << ", pattern " << n;
      }
    }
  });
}

// Stripes 8 pixels wide, along columns: all edges have one direction, level by level.
TEST(DenseFeaturesOfStripesTest, HaveOneDirection) {
  cv::Mat stripes(48, 48, CV_8UC3, cv::Scalar::all(60));
  for (int u = 0; u < 48; u += 16) stripes.colRange(u, u + 8).setTo(cv::Scalar::all(180));
  const DenseFeatures features = denseFeatures(stripes, PhotometricCorrection().responses());
  for (size_t point = 0; point < features.numPoints(); ++point) {
    EXPECT_GT(features.values[kTex][8 * point + 6], 1000);  // coherence, nearly 1024
    EXPECT_GT(features.values[kHog][16 * point], 900);      // the strongest direction
    EXPECT_EQ(features.values[kHog][16 * point + 1], 0);
  }
}

TEST(DenseFeaturesOfAPlainPictureTest, SayThatThereIsNothing) {
  const cv::Mat plain(24, 24, CV_8UC3, cv::Scalar(40, 90, 160));
  const DenseFeatures features = denseFeatures(plain, PhotometricCorrection().responses());
  for (size_t point = 0; point < features.numPoints(); ++point) {
    for (size_t d = 0; d < 6; ++d) EXPECT_EQ(features.values[kTex][8 * point + d], 6 * 128);  // log2(64)
    for (size_t d = 0; d < 16; ++d) EXPECT_EQ(features.values[kHog][16 * point + d], 0);
    for (size_t d = 0; d < 30; ++d) EXPECT_EQ(features.values[kLbp][30 * point + d], d % 10 == 0 ? 1024 : 0);
    for (size_t d = 0; d < 3; ++d) EXPECT_EQ(features.values[kStd24][3 * point + d], 4 * 128);  // log2(16)
  }
}

TEST(DenseFeaturesOfExtremesTest, StayWithinTheirRange) {
  cv::Mat board(64, 64, CV_8UC3, cv::Scalar::all(0));
  for (int v = 0; v < 64; ++v) {
    for (int u = v % 2; u < 64; u += 2) board.at<cv::Vec3b>(v, u) = {255, 255, 0};
  }
  ChannelResponses loud{};
  for (auto& channel : loud) {
    for (size_t value = 1; value < 256; ++value) channel[value] = kMaxCorrected;
  }
  for (const cv::Mat& picture : {board, cv::Mat(64, 64, CV_8UC3, cv::Scalar(255, 0, 0)),
                                 cv::Mat(64, 64, CV_8UC3, cv::Scalar(0, 255, 0))}) {
    const DenseFeatures features = denseFeatures(picture, loud);
    for (const auto& values : features.values) {
      for (const int16_t value : values) ASSERT_LE(std::abs(value), kMaxFeature);
    }
  }
}

// sRGB's curve and ours differ by little, and OpenCV rounds to 8 bits.
TEST(PerceivedColorTest, IsCieLab) {
  const auto colorOf = [](int blue, int green, int red) {
    return perceivedColor(linearLight(16 * blue), linearLight(16 * green), linearLight(16 * red));
  };
  for (int grey = 0; grey < 256; ++grey) {
    const PerceivedColor color = colorOf(grey, grey, grey);
    EXPECT_EQ(color.a, 0) << grey;
    EXPECT_EQ(color.b, 0) << grey;
  }
  EXPECT_EQ(colorOf(255, 255, 255).lightness, 100 * kLabSteps);
  EXPECT_EQ(colorOf(0, 0, 0).lightness, 0);
  const auto near = [](const PerceivedColor& color, double lightness, double a, double b) {
    EXPECT_NEAR(color.lightness, kLabSteps * lightness, 2 * kLabSteps);
    EXPECT_NEAR(color.a, kLabSteps * a, 2 * kLabSteps);
    EXPECT_NEAR(color.b, kLabSteps * b, 2 * kLabSteps);
  };
  near(colorOf(0, 0, 255), 53.24, 80.09, 67.20);  // the primaries of sRGB
  near(colorOf(0, 255, 0), 87.73, -86.18, 83.18);
  near(colorOf(255, 0, 0), 32.30, 79.19, -107.86);
  near(colorOf(128, 128, 128), 53.59, 0, 0);
}

}  // namespace
}  // namespace shoal::vision
