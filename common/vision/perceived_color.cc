// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/perceived_color.h"

#include <cmath>
#include <vector>

#include "shoal/vision/fixed_math.h"
#include "shoal/vision/photometric_correction.h"

namespace shoal::vision {
namespace {

constexpr int kLightBits = 13;
constexpr int kRootBits = 14;
constexpr int32_t kWhite = 16 * 255;

// CIE's f(t): the cube root, and a straight line in the dark. t and f in steps of 2^-13 and 2^-14.
int32_t cieRoot(int32_t t) {
  if (t > 72)
    return static_cast<int32_t>(integerCubeRoot(static_cast<uint64_t>(t) << (3 * kRootBits - kLightBits)));
  return ((15948 * t) >> 10) + 2260;  // 7.787 t + 16 / 116
}

std::vector<int16_t> cieRoots() {
  std::vector<int16_t> roots(static_cast<size_t>(linearLight(kMaxCorrected)) + 1);
  for (size_t t = 0; t < roots.size(); ++t) roots[t] = static_cast<int16_t>(cieRoot(static_cast<int32_t>(t)));
  return roots;
}

}  // namespace

int32_t linearLight(int32_t corrected) {
  const double x = static_cast<double>(corrected) / kWhite;
  return static_cast<int32_t>(std::lround(x * x * std::sqrt(std::sqrt(x)) * (1 << kLightBits)));
}

PerceivedColor perceivedColor(int32_t blue, int32_t green, int32_t red) {
  static const std::vector<int16_t> roots = cieRoots();
  // CIE X, Y, Z of sRGB's primaries over those of white: each row sums to 4096.
  const auto root = [&](int32_t r, int32_t g, int32_t b) {
    return int32_t{roots[static_cast<size_t>((r * red + g * green + b * blue) >> 12)]};
  };
  const int32_t x = root(1777, 1541, 778), y = root(871, 2929, 296), z = root(73, 448, 3575);
  constexpr int32_t kHalf = 1 << (kRootBits - 1);
  return {.lightness = ((116 * kLabSteps * y + kHalf) >> kRootBits) - 16 * kLabSteps,
          .a = (500 * kLabSteps * (x - y) + kHalf) >> kRootBits,
          .b = (200 * kLabSteps * (y - z) + kHalf) >> kRootBits};
}

}  // namespace shoal::vision
