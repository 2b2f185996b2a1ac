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
  int32_t level = 150;      ///< 8-bit value that the mean of every channel is brought to
  int32_t power = 6;        ///< of the mean
  int32_t max_octaves = 2;  ///< gains lie in [2^-n, 2^n]
};
inline constexpr PhotometricSettings kPhotometricSettings{};

/// Takes out a robot's own brightness and colour cast: shades of grey over all of its images so far. A camera
/// that is k times as bright, or has a cast, multiplies each channel by a constant; so every channel is
/// scaled to bring its power mean, (mean of value^6)^(1/6) over all pixels of all images so far, to a fixed
/// level. What a constant gain does to a robot's pictures is thereby undone, but for rounding and for what
/// was clipped at white.
///
/// What makes a robot's area unlike the others' in that mean is taken out too: that is the price. It is
/// low with the sixth power, which looks to the bright things that most areas have. A plain or geometric
/// mean (grey world) turns sea grey where a robot sees little else.
///
/// Each image has one vote, the first one too. Integers only: equal images, equal responses, on every
/// machine. One object belongs to one robot. Source: G. Finlayson and E. Trezzi, "Shades of Gray and Colour
/// Constancy", 2004, who recommend the sixth power as well.
class PhotometricCorrection {
 public:
  /// Counts an image in.
  /// @param bgr  CV_8UC3, not empty, at most 2^28 pixels. Cost: one pass.
  void observe(const cv::Mat& bgr);

  /// All it has learnt: one number a channel and the number of images.
  std::array<int64_t, 4> state() const {
    return {sum_of_means_[0], sum_of_means_[1], sum_of_means_[2], num_images_};
  }

  /// What another had learnt, in place of its own.
  /// @throws std::invalid_argument for numbers that no images give.
  void restore(const std::array<int64_t, 4>& state);

  /// The correction by all images so far. With none, values stay as they are (in steps of 1/16).
  ChannelResponses responses() const;

 private:
  std::array<int64_t, 3> sum_of_means_{};  // over images, of the mean of value^6, in steps of 2^14
  int64_t num_images_ = 0;
};

}  // namespace shoal::vision
