// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "shoal/vision/block_sums.h"
#include "shoal/vision/photometric_correction.h"
#include "shoal/vision/plane.h"

namespace shoal::vision {

/// What is summed over a block's 64 pixels: CIE L, a, b (perceived_color.h), their squares, and the corrected
/// channels.
enum ColorSum : size_t { kL, kA, kB, kLSquared, kASquared, kBSquared, kBlue, kGreen, kRed, kNumColorSums };

/// A corrected picture: colour by block, luminance by pixel.
struct CorrectedPicture {
  BlockSums<kNumColorSums> colors;  ///< ⌊width / 8⌋ x ⌊height / 8⌋ blocks
  /// log2(Y + 128), Y the luminance (54 R + 183 G + 19 B) / 256 of the corrected channels, in steps of 2^-10,
  /// in [7168, 13334]: texture in shade is as strong as in light, but for the darkest eight of 256 levels.
  Plane log_luminance;  ///< of whole blocks, so columns and rows are multiples of 8; border filled
};

/// @param bgr  CV_8UC3, at least 8 x 8 pixels; up to 7 columns on the right and rows at the bottom are left
/// out. Cost: one pass with some ten look-ups a pixel.
CorrectedPicture correct(const cv::Mat& bgr, const ChannelResponses& responses);

}  // namespace shoal::vision
