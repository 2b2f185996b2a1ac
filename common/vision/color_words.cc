// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/color_words.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "shoal/demand.h"

namespace shoal::vision {

std::vector<PixelWord> colorWords(const cv::Mat& bgr, int32_t first_hue, int32_t first_intensity) {
  SHOAL_DEMAND(bgr.type() == CV_8UC3 && bgr.cols >= kThumbnailColumns);
  const int columns = kThumbnailColumns;
  const int rows = std::max(1, static_cast<int>(std::lround(double{columns} * bgr.rows / bgr.cols)));
  cv::Mat thumbnail;
  cv::resize(bgr, thumbnail, {columns, rows}, 0, 0, cv::INTER_AREA);
  cv::cvtColor(thumbnail, thumbnail, cv::COLOR_BGR2HSV);

  const auto middle = [](int block, int size, int blocks) {
    return static_cast<int>((2 * int64_t{block} + 1) * size / (2 * int64_t{blocks}));
  };
  std::vector<PixelWord> words;
  words.reserve(2 * static_cast<size_t>(columns) * static_cast<size_t>(rows));
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const auto& hsv = thumbnail.at<cv::Vec3b>(j, i);
      const int u = middle(i, bgr.cols, columns);
      const int v = middle(j, bgr.rows, rows);
      words.push_back({u, v, first_hue + hsv[0]});
      words.push_back({u, v, first_intensity + hsv[2]});
    }
  }
  return words;
}

}  // namespace shoal::vision
