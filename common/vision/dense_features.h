// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "shoal/vision/photometric_correction.h"

namespace shoal::vision {

/// Every feature lies in [-kMaxFeature, kMaxFeature].
inline constexpr int32_t kMaxFeature = 4095;

/// A kind of feature, with a vocabulary of its own. Unless said, over the window of 24 x 24 pixels around
/// the point; log-luminance is that of color_blocks.h, its levels are the image, halved once and twice.
struct FeatureKind {
  std::string_view name;
  int dimensions;  ///< in [1, 32]
  int num_words;   ///< of the vocabulary that is trained
};

enum FeatureKindIndex : size_t { kLab24, kLab8, kChr24, kTex, kHog, kLbp, kStd24, kNumFeatureKinds };

inline constexpr std::array<FeatureKind, kNumFeatureKinds> kFeatureKinds{{
    {"lab24", 3, 200},  ///< mean of CIE L, a, b, in steps of 1/8
    {"lab8", 3, 200},   ///< the same over the point's own 8 x 8 pixels
    {"chr24", 2, 100},  ///< log2 of mean red over mean green, and of blue over green, in steps of 2^-10
    {"tex", 8, 200},  ///< log2 of mean energy in steps of 2^-7: blobs on three levels, edges on three levels;
                      ///< coherence of edges on levels 0 and 1, in steps of 2^-10
    {"hog", 16, 200},  ///< square roots of shares of edge strength in eight directions, on levels 0 and 1, in
                       ///< steps of 2^-10, from the strongest direction of its level on
    {"lbp", 30, 200},  ///< square roots of shares of ten patterns on levels 0, 1 and 2, in steps of 2^-10
    {"std24", 3, 100},  ///< log2 of the variance of CIE L, a, b, in steps of 2^-7
}};

/// Features at the points of an image: the middles of its 8 x 8 blocks, row by row. Point (i, j) is at pixel
/// (8 i + 4, 8 j + 4). Windows end at the edge of the image.
struct DenseFeatures {
  int columns = 0, rows = 0;                                  ///< of points
  std::array<std::vector<int16_t>, kNumFeatureKinds> values;  ///< by kind: points x dimensions

  size_t numPoints() const { return static_cast<size_t>(columns) * static_cast<size_t>(rows); }
};

/// Pure and exact: integers only, the same on every machine.
/// @param bgr  CV_8UC3, at least 8 x 8 pixels; up to 7 columns on the right and rows at the bottom are left
/// out.
DenseFeatures denseFeatures(const cv::Mat& bgr, const ChannelResponses& responses);

}  // namespace shoal::vision
