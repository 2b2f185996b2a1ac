// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "shoal/vision/block_sums.h"
#include "shoal/vision/plane.h"

namespace shoal::vision {

/// Directions of an edge, each 22.5 degrees of a half turn.
inline constexpr int kNumDirections = 8;

/// Patterns of a pixel's ring: with at most two changes around it, the number of brighter neighbours (0 to
/// 8); 9 for all others. "Rotation-invariant uniform" in T. Ojala et al. 2002.
inline constexpr int kNumPatterns = 10;

/// A neighbour counts as brighter only by this much, steps of 2^-10 of log2: 1.1 %, an 8-bit step at
/// middle grey, so that noise of smooth ground is no pattern.
inline constexpr int32_t kBrighter = 16;

/// What is summed over the pixels of a block. I is the image after smoothing by (1 2 1)/4 in columns and
/// rows, rounded; gx = I(u+1, v) - I(u-1, v), gy alike.
enum TextureSum : size_t {
  kXX,              ///< gx gx
  kYY,              ///< gy gy
  kXY,              ///< gx gy
  kBlob,            ///< square of 4 I minus the four neighbours
  kFirstDirection,  ///< by direction of (gx, gy), nearest multiple of 22.5 degrees: max + 3/8 min of |gx|,
                    ///< |gy|
  kFirstPattern = kFirstDirection + kNumDirections,  ///< pixels by pattern of the image that is not smoothed
  kNumTextureSums = kFirstPattern + kNumPatterns
};

using TextureBlocks = BlockSums<kNumTextureSums>;

/// @param image       border filled, columns and rows multiples of `block_size`, values in [0, 16383].
/// @param block_size  pixels.
TextureBlocks textureBlocks(const Plane& image, int block_size);

/// Half as large: means of 2 x 2 pixels, rounded; border filled.
/// @param image  columns and rows even.
Plane halved(const Plane& image);

}  // namespace shoal::vision
