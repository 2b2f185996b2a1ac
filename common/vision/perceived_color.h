// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

namespace shoal::vision {

/// Steps of a perceived colour in one CIE unit.
inline constexpr int32_t kLabSteps = 8;

/// CIE L, a, b in steps of 1/8. White is L = 100, a = b = 0; grey has a = b = 0 exactly.
struct PerceivedColor {
  int32_t lightness = 0, a = 0, b = 0;
};

/// Linear light of a corrected channel value, in steps of 2^-13 of white: the power 2.25, within 0.02 of what
/// sRGB has, and exact in IEEE arithmetic by two square roots.
/// @param corrected  in [0, kMaxCorrected] (photometric_correction.h).
int32_t linearLight(int32_t corrected);

/// The colour of linear light, D65. OpenCV's 8-bit conversion differs by about a unit, and clips at white.
/// @param blue, green, red  as linearLight() gives them. Cost: some ten operations and three look-ups.
PerceivedColor perceivedColor(int32_t blue, int32_t green, int32_t red);

}  // namespace shoal::vision
