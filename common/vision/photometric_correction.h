// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace shoal::vision {

/// A corrected channel value is in steps of 1/16 of an 8-bit step. There is headroom to twice 8-bit white,
/// so that what is bright in a dark robot's pictures does not clip.
inline constexpr int32_t kMaxCorrected = 8191;

/// What each of the 256 values of a channel becomes, in [0, kMaxCorrected], not decreasing; blue, green, red.
using ChannelResponses = std::array<std::array<int16_t, 256>, 3>;

/// The settings of PhotometricCorrection, for fingerprints.
struct PhotometricSettings {
  int32_t level = 112;      ///< 8-bit value that the mean of every channel is brought to
  int32_t max_octaves = 2;  ///< gains lie in [2^-n, 2^n]
};
inline constexpr PhotometricSettings kPhotometricSettings{};

/// Takes out a robot's own brightness and colour cast: grey world over all of its images so far. A camera
/// that is k times as bright, or has a cast, multiplies each channel by a constant; so every channel is
/// scaled to bring its geometric mean over all pixels of all images so far to a fixed level. What a constant
/// gain does to a robot's pictures is thereby undone, but for rounding and for what was clipped at white. So
/// is what makes its area unlike the others' in the mean of a channel: that is the price.
///
/// The mean is geometric since gains then shift it, and few bright pixels do not decide it. Each image has
/// one vote, the first one too. Integers only: equal images, equal responses, on every machine. One
/// object belongs to one robot.
class PhotometricCorrection {
 public:
  /// Counts an image in.
  /// @param bgr  CV_8UC3, not empty. Cost: one pass.
  void observe(const cv::Mat& bgr);

  /// The correction by all images so far. With none, values stay as they are (in steps of 1/16).
  ChannelResponses responses() const;

 private:
  std::array<int64_t, 3> sum_of_logs_{};  // over images, of the mean of log2(value + 1), in steps of 2^-16
  int64_t num_images_ = 0;
};

}  // namespace shoal::vision
