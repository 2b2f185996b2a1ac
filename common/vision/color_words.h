// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "shoal/vision/pixel_word.h"

namespace shoal::vision {

inline constexpr int kThumbnailColumns = 32;
inline constexpr int32_t kNumHues = 180;         ///< OpenCV's 8-bit hue, 2 degrees a step
inline constexpr int32_t kNumIntensities = 256;  ///< the V of HSV

/// Shrinks a picture to 32 columns (rows in proportion, at least one) by averaging areas. Every pixel of the
/// thumbnail gives a hue word at `first_hue` + hue and an intensity word at `first_intensity` + V, both at
/// the middle pixel of its block: column ⌊(2i + 1) width / 64⌋, likewise for rows. Row by row, hue first. A
/// picture of 4:3 gives 1536 words.
/// @param bgr  CV_8UC3, at least 32 columns.
std::vector<PixelWord> colorWords(const cv::Mat& bgr, int32_t first_hue, int32_t first_intensity);

}  // namespace shoal::vision
