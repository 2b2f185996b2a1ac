// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace shoal::world {

/// Gradient noise over the torus: smooth, mean 0, about [-1, 1], with features one unit wide, repeating
/// after `period` >= 1 units in x and in y. Pure.
/// Source: K. Perlin, "Improving Noise", SIGGRAPH 2002.
float gradientNoise(uint64_t seed, int period, float x, float y);

/// Gradient noise summed over `octaves` >= 1, each of half the width and half the height; about [-1, 1].
float fractalNoise(uint64_t seed, int period, int octaves, float x, float y);

/// Where a point lies among random sites, one in each unit square.
struct SiteDistances {
  float nearest = 0, second = 0;  ///< units
  uint32_t site = 0;              ///< hash of the nearest site, the same all over its region
};

/// Cellular noise over the torus of `period` >= 1 units.
/// Source: S. Worley, "A Cellular Texture Basis Function", SIGGRAPH 1996.
SiteDistances cellularNoise(uint64_t seed, int period, float x, float y);

/// About cos(2 pi turns), within 0.002 of it, from additions and products alone, so that it is the same on
/// every machine; |turns| < 2^22.
float cosineOfTurns(float turns);

}  // namespace shoal::world
