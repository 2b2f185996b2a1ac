// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include <opencv2/core/mat.hpp>

namespace shoal::vision {

/// Contrast limit and tiles a side of the adaptive histogram equalisation, as the paper's implementation.
inline constexpr int kClaheClipLimit = 4;
inline constexpr int kClaheTiles = 8;

/// CIE L, a, b of a picture, 8 bits each (OpenCV's scaling), after contrast-limited adaptive histogram
/// equalisation of L.
struct EqualizedChannels {
  std::array<cv::Mat, 3> lab;  ///< CV_8UC1 each, of the picture's size
  cv::Mat bgr;                 ///< CV_8UC3, the same picture back in BGR
};

/// @param bgr  CV_8UC3. @throws std::invalid_argument for any other type or an empty picture.
EqualizedChannels equalize(const cv::Mat& bgr);

}  // namespace shoal::vision
