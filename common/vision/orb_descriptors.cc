// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/orb_descriptors.h"

#include <algorithm>
#include <cmath>

#include <opencv2/features2d.hpp>

#include "shoal/demand.h"

namespace shoal::vision {

std::vector<OrbDescriptor> orbDescriptors(const cv::Mat& channel) {
  SHOAL_DEMAND(channel.type() == CV_8UC1);
  std::vector<cv::KeyPoint> points;
  cv::Mat descriptors;
  cv::ORB::create(kOrbKeyPoints)->detectAndCompute(channel, cv::noArray(), points, descriptors);

  std::vector<OrbDescriptor> result;
  result.reserve(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    // A point found on a coarse level may round to just outside.
    const int u = std::clamp(static_cast<int>(std::lround(points[i].pt.x)), 0, channel.cols - 1);
    const int v = std::clamp(static_cast<int>(std::lround(points[i].pt.y)), 0, channel.rows - 1);
    result.push_back({u, v, binaryWord(descriptors.ptr<uint8_t>(static_cast<int>(i)))});
  }
  return result;
}

}  // namespace shoal::vision
