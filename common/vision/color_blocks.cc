// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/color_blocks.h"

#include <array>

#include "shoal/demand.h"
#include "shoal/vision/fixed_math.h"
#include "shoal/vision/perceived_color.h"

namespace shoal::vision {
namespace {

constexpr int kLogBits = 10;
constexpr int32_t kDark = 128;  // 8 of 256 levels

std::array<int16_t, kMaxCorrected + 1> logsOfLuminance() {
  std::array<int16_t, kMaxCorrected + 1> logs{};
  for (size_t y = 0; y < logs.size(); ++y) logs[y] = static_cast<int16_t>(fixedLog2(y + kDark, kLogBits));
  return logs;
}

std::array<std::array<int32_t, 256>, 3> lightOf(const ChannelResponses& responses) {
  std::array<std::array<int32_t, 256>, 3> light{};
  for (size_t c = 0; c < 3; ++c) {
    for (size_t value = 0; value < 256; ++value) light[c][value] = linearLight(responses[c][value]);
  }
  return light;
}

}  // namespace

CorrectedPicture correct(const cv::Mat& bgr, const ChannelResponses& responses) {
  SHOAL_DEMAND(bgr.type() == CV_8UC3 && bgr.cols >= kBlockSize && bgr.rows >= kBlockSize);
  static const std::array<int16_t, kMaxCorrected + 1> logs = logsOfLuminance();
  const std::array<std::array<int32_t, 256>, 3> light = lightOf(responses);
  const int columns = bgr.cols / kBlockSize, rows = bgr.rows / kBlockSize;
  CorrectedPicture picture{{columns, rows}, {kBlockSize * columns, kBlockSize * rows}};
  for (int v = 0; v < picture.log_luminance.rows(); ++v) {
    const uint8_t* pixel = bgr.ptr<uint8_t>(v);
    int16_t* log_luminance = picture.log_luminance.row(v);
    for (int i = 0; i < columns; ++i) {
      auto& sums = picture.colors.at(i, v / kBlockSize);
      for (int n = 0; n < kBlockSize; ++n, pixel += 3) {
        const int32_t blue = responses[0][pixel[0]], green = responses[1][pixel[1]],
                      red = responses[2][pixel[2]];
        const PerceivedColor color =
            perceivedColor(light[0][pixel[0]], light[1][pixel[1]], light[2][pixel[2]]);
        sums[kL] += color.lightness;
        sums[kA] += color.a;
        sums[kB] += color.b;
        sums[kLSquared] += color.lightness * color.lightness;
        sums[kASquared] += color.a * color.a;
        sums[kBSquared] += color.b * color.b;
        sums[kBlue] += blue;
        sums[kGreen] += green;
        sums[kRed] += red;
        *log_luminance++ = logs[static_cast<size_t>((54 * red + 183 * green + 19 * blue) >> 8)];
      }
    }
  }
  picture.log_luminance.fillBorder();
  return picture;
}

}  // namespace shoal::vision
