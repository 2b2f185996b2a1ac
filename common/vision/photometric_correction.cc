// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/photometric_correction.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "shoal/demand.h"
#include "shoal/vision/fixed_math.h"

namespace shoal::vision {
namespace {

constexpr int kPowerLogBits = 16;
constexpr int64_t kPowerStep = 1 << 14;  // so that the sum over an image stays below 2^63

int64_t powerOf(int64_t value) {
  int64_t power = 1;
  for (int n = 0; n < kPhotometricSettings.power; ++n) power *= value;
  return power / kPowerStep;
}

// log2 of the value whose power this is.
int32_t logOfValue(int64_t power) {
  return fixedLog2(static_cast<uint64_t>(power) + 1, kPowerLogBits) / kPhotometricSettings.power;
}

}  // namespace

void PhotometricCorrection::observe(const cv::Mat& bgr) {
  SHOAL_DEMAND(bgr.type() == CV_8UC3 && !bgr.empty() && bgr.total() <= size_t{1} << 28);
  std::array<std::array<int64_t, 256>, 3> counts{};
  for (int v = 0; v < bgr.rows; ++v) {
    const uint8_t* pixel = bgr.ptr<uint8_t>(v);
    for (int u = 0; u < bgr.cols; ++u, pixel += 3) {
      for (size_t c = 0; c < 3; ++c) ++counts[c][pixel[c]];
    }
  }
  for (size_t c = 0; c < 3; ++c) {
    int64_t sum = 0;
    for (int value = 0; value < 256; ++value) sum += counts[c][static_cast<size_t>(value)] * powerOf(value);
    sum_of_means_[c] += sum / (int64_t{bgr.rows} * bgr.cols);
  }
  ++num_images_;
}

void PhotometricCorrection::restore(const std::array<int64_t, 4>& state) {
  const int64_t images = state[3];
  for (size_t c = 0; c < 3; ++c) {
    if (images < 0 || images > INT32_MAX || state[c] < 0 || state[c] > images * (powerOf(255) + 1)) {
      throw std::invalid_argument("a mean of " + std::to_string(state[c]) + " over " +
                                  std::to_string(images) + " images is not a correction's");
    }
  }
  sum_of_means_ = {state[0], state[1], state[2]};
  num_images_ = images;
}

ChannelResponses PhotometricCorrection::responses() const {
  constexpr int32_t kMost = kPhotometricSettings.max_octaves << kPowerLogBits;
  ChannelResponses responses;
  for (size_t c = 0; c < 3; ++c) {
    int32_t octaves = 0;  // of gain, in steps of 2^-16
    if (num_images_ > 0) {
      const int32_t wanted = logOfValue(powerOf(kPhotometricSettings.level));
      octaves = std::clamp(wanted - logOfValue(sum_of_means_[c] / num_images_), -kMost, kMost);
    }
    const uint64_t gain = fixedExp2(octaves);  // in steps of 2^-16
    for (size_t value = 0; value < 256; ++value) {
      const uint64_t corrected = (16 * value * gain + (1 << 15)) >> 16;
      responses[c][value] = static_cast<int16_t>(std::min<uint64_t>(corrected, kMaxCorrected));
    }
  }
  return responses;
}

}  // namespace shoal::vision
