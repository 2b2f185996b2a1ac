// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/texture_blocks.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>

#include "shoal/demand.h"

namespace shoal::vision {
namespace {

Plane smoothed(const Plane& image) {
  Plane result(image.columns(), image.rows());
  std::vector<int32_t> columns(static_cast<size_t>(image.columns()) + 2);
  for (int v = 0; v < image.rows(); ++v) {
    const int16_t *above = image.row(v - 1) - 1, *here = image.row(v) - 1, *below = image.row(v + 1) - 1;
    for (size_t u = 0; u < columns.size(); ++u) columns[u] = above[u] + 2 * here[u] + below[u];
    int16_t* out = result.row(v);
    for (size_t u = 0; u + 2 < columns.size(); ++u) {
      out[u] = static_cast<int16_t>((columns[u] + 2 * columns[u + 1] + columns[u + 2] + 8) >> 4);
    }
  }
  result.fillBorder();
  return result;
}

// The multiple of 22.5 degrees nearest to the direction of (gx, gy), up to half a turn.
int directionOf(int32_t gx, int32_t gy) {
  constexpr int32_t kTan11 = 204, kTan34 = 684;  // of 11.25 and 33.75 degrees, in steps of 1/1024
  const int32_t x = std::abs(gx), y = std::abs(gy);
  const int quarter =
      (1024 * y > kTan11 * x) + (1024 * y > kTan34 * x) + (kTan34 * y > 1024 * x) + (kTan11 * y > 1024 * x);
  return (gx ^ gy) < 0 ? (kNumDirections - quarter) % kNumDirections : quarter;
}

std::array<uint8_t, 256> patternOfRing() {
  std::array<uint8_t, 256> patterns{};
  for (unsigned ring = 0; ring < 256; ++ring) {
    const auto bits = static_cast<uint8_t>(ring);
    const int changes = std::popcount(static_cast<uint8_t>(bits ^ std::rotl(bits, 1)));
    patterns[ring] = static_cast<uint8_t>(changes <= 2 ? std::popcount(bits) : kNumPatterns - 1);
  }
  return patterns;
}

}  // namespace

TextureBlocks textureBlocks(const Plane& image, int block_size) {
  SHOAL_DEMAND(image.columns() % block_size == 0 && image.rows() % block_size == 0);
  static const std::array<uint8_t, 256> patterns = patternOfRing();
  const Plane smooth = smoothed(image);
  TextureBlocks blocks(image.columns() / block_size, image.rows() / block_size);
  for (int v = 0; v < image.rows(); ++v) {
    const int16_t *smooth_above = smooth.row(v - 1), *smooth_here = smooth.row(v),
                  *smooth_below = smooth.row(v + 1);
    const int16_t *above = image.row(v - 1), *here = image.row(v), *below = image.row(v + 1);
    for (int i = 0; i < blocks.columns(); ++i) {
      auto& sums = blocks.at(i, v / block_size);
      for (int u = i * block_size; u < (i + 1) * block_size; ++u) {
        const int32_t left = smooth_here[u - 1], right = smooth_here[u + 1];
        const int32_t up = smooth_above[u], down = smooth_below[u];
        const int64_t gx = right - left, gy = down - up, blob = 4 * smooth_here[u] - left - right - up - down;
        sums[kXX] += gx * gx;
        sums[kYY] += gy * gy;
        sums[kXY] += gx * gy;
        sums[kBlob] += blob * blob;
        const int64_t least = std::min(std::abs(gx), std::abs(gy)),
                      most = std::max(std::abs(gx), std::abs(gy));
        const int direction = directionOf(right - left, down - up);
        sums[kFirstDirection + static_cast<size_t>(direction)] += most + 3 * least / 8;

        const int32_t bar = here[u] + kBrighter;
        const int ring = (above[u - 1] >= bar) | (above[u] >= bar) << 1 | (above[u + 1] >= bar) << 2 |
                         (here[u + 1] >= bar) << 3 | (below[u + 1] >= bar) << 4 | (below[u] >= bar) << 5 |
                         (below[u - 1] >= bar) << 6 | (here[u - 1] >= bar) << 7;
        ++sums[kFirstPattern + patterns[static_cast<size_t>(ring)]];
      }
    }
  }
  return blocks;
}

Plane halved(const Plane& image) {
  SHOAL_DEMAND(image.columns() % 2 == 0 && image.rows() % 2 == 0);
  Plane half(image.columns() / 2, image.rows() / 2);
  for (int v = 0; v < half.rows(); ++v) {
    const int16_t *top = image.row(2 * v), *bottom = image.row(2 * v + 1);
    int16_t* out = half.row(v);
    for (int u = 0; u < half.columns(); ++u) {
      out[u] =
          static_cast<int16_t>((top[2 * u] + top[2 * u + 1] + bottom[2 * u] + bottom[2 * u + 1] + 2) >> 2);
    }
  }
  half.fillBorder();
  return half;
}

}  // namespace shoal::vision
