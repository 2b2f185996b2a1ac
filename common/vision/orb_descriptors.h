// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "shoal/vision/binary_word.h"

namespace shoal::vision {

/// Most key points in one channel.
inline constexpr int kOrbKeyPoints = 1000;

/// A described key point, at the nearest pixel.
struct OrbDescriptor {
  int u = 0;  ///< columns from the left
  int v = 0;  ///< rows from the top
  BinaryWord bits{};
};

/// OpenCV's ORB with its default pyramid (8 levels of scale 1.2, patches of 31 pixels, FAST threshold 20,
/// Harris score). A picture without corners, or under about 63 pixels a side, has none. Deterministic, and
/// the same with any number of OpenCV threads.
/// @param channel  CV_8UC1.
std::vector<OrbDescriptor> orbDescriptors(const cv::Mat& channel);

}  // namespace shoal::vision
