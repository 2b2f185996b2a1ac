// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/equalized_channels.h"

#include <stdexcept>

#include <opencv2/imgproc.hpp>

namespace shoal::vision {
namespace {

// OpenCV fills its tables of Lab at the first conversion without a lock: here it does so once, whatever the
// number of threads.
void fillLabTables() {
  static const bool filled = [] {
    cv::Mat pixel(1, 1, CV_8UC3, cv::Scalar::all(0)), lab;
    cv::cvtColor(pixel, lab, cv::COLOR_BGR2Lab);
    cv::cvtColor(lab, pixel, cv::COLOR_Lab2BGR);
    return true;
  }();
  static_cast<void>(filled);
}

}  // namespace

EqualizedChannels equalize(const cv::Mat& bgr) {
  fillLabTables();
  if (bgr.empty() || bgr.type() != CV_8UC3) {
    throw std::invalid_argument("a colour picture must be CV_8UC3 and not empty");
  }
  EqualizedChannels result;
  cv::Mat lab;
  cv::cvtColor(bgr, lab, cv::COLOR_BGR2Lab);
  cv::split(lab, result.lab.data());
  cv::Mat lightness;
  cv::createCLAHE(kClaheClipLimit, {kClaheTiles, kClaheTiles})->apply(result.lab[0], lightness);
  result.lab[0] = lightness;
  cv::merge(result.lab.data(), result.lab.size(), lab);
  cv::cvtColor(lab, result.bgr, cv::COLOR_Lab2BGR);
  return result;
}

}  // namespace shoal::vision
