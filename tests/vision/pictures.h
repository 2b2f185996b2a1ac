// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

#include "shoal/random.h"
#include "shoal/world/observation.h"

namespace shoal::vision {

// Coloured rectangles of all sizes at random places: plenty of corners on every channel.
inline cv::Mat rectangles(cv::Size size, uint64_t seed) {
  cv::Mat picture(size, CV_8UC3, cv::Scalar(90, 120, 140));
  Random random(seed);
  const auto below = [&](int n) { return static_cast<int>(random.below(static_cast<uint64_t>(n))); };
  for (int i = 0; i < 400; ++i) {
    const cv::Rect box(below(size.width), below(size.height), 3 + below(30), 3 + below(30));
    picture(box & cv::Rect({0, 0}, size)).setTo(cv::Scalar(below(256), below(256), below(256)));
  }
  return picture;
}

// The picture seen from `altitude_m` straight above the world's origin.
inline world::Observation seenFromAbove(const cv::Mat& picture, double altitude_m) {
  world::Observation observation;
  observation.number = 7;
  observation.time = world::Timestamp{7'000'000};
  observation.color = picture;
  observation.depth_m = cv::Mat(picture.size(), CV_32FC1, cv::Scalar(altitude_m));
  observation.intrinsics.width = picture.cols;
  observation.intrinsics.height = picture.rows;
  observation.intrinsics.cx = (picture.cols - 1) / 2.0;
  observation.intrinsics.cy = (picture.rows - 1) / 2.0;
  observation.world_from_camera = world::lookingDown({0.0, 0.0, altitude_m});
  return observation;
}

}  // namespace shoal::vision
