// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "shoal/random.h"

namespace shoal::world {
namespace {

int wrap(int i, int period) {
  const int rest = i % period;
  return rest < 0 ? rest + period : rest;
}

uint64_t latticeHash(uint64_t seed, int x, int y) {
  return mix64(seed ^ (static_cast<uint64_t>(static_cast<uint32_t>(x)) << 32 | static_cast<uint32_t>(y)));
}

/// The slope at a lattice point (eight directions of length 1 to sqrt 2), times the way from there.
float corner(uint64_t hash, float dx, float dy) {
  static constexpr std::array<std::pair<float, float>, 8> kSlopes{
      {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {.7f, .7f}, {-.7f, .7f}, {.7f, -.7f}, {-.7f, -.7f}}};
  const auto& [sx, sy] = kSlopes[hash & 7];
  return sx * dx + sy * dy;
}

float fade(float t) { return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f); }

float lerp(float a, float b, float t) { return a + (b - a) * t; }

}  // namespace

float gradientNoise(uint64_t seed, int period, float x, float y) {
  const float floor_x = std::floor(x), floor_y = std::floor(y);
  const int x0 = wrap(static_cast<int>(floor_x), period), y0 = wrap(static_cast<int>(floor_y), period);
  const int x1 = x0 + 1 == period ? 0 : x0 + 1, y1 = y0 + 1 == period ? 0 : y0 + 1;
  const float dx = x - floor_x, dy = y - floor_y;
  const float top = lerp(corner(latticeHash(seed, x0, y0), dx, dy),
                         corner(latticeHash(seed, x1, y0), dx - 1.0f, dy), fade(dx));
  const float bottom = lerp(corner(latticeHash(seed, x0, y1), dx, dy - 1.0f),
                            corner(latticeHash(seed, x1, y1), dx - 1.0f, dy - 1.0f), fade(dx));
  return 1.5f * lerp(top, bottom, fade(dy));
}

float fractalNoise(uint64_t seed, int period, int octaves, float x, float y) {
  float sum = 0.0f, height = 0.6f;
  for (int octave = 0; octave < octaves; ++octave) {
    const float scale = static_cast<float>(1 << octave);
    sum += height * gradientNoise(hashCombine(seed, static_cast<uint64_t>(octave)), period << octave,
                                  x * scale, y * scale);
    height *= 0.5f;
  }
  return sum;
}

SiteDistances cellularNoise(uint64_t seed, int period, float x, float y) {
  const int cell_x = static_cast<int>(std::floor(x)), cell_y = static_cast<int>(std::floor(y));
  SiteDistances found{9.0f, 9.0f, 0};
  for (int j = cell_y - 1; j <= cell_y + 1; ++j) {
    for (int i = cell_x - 1; i <= cell_x + 1; ++i) {
      const uint64_t hash = latticeHash(seed, wrap(i, period), wrap(j, period));
      const float site_x = static_cast<float>(i) + static_cast<float>(hash & 0xffff) * 0x1p-16f;
      const float site_y = static_cast<float>(j) + static_cast<float>(hash >> 16 & 0xffff) * 0x1p-16f;
      const float squared = (site_x - x) * (site_x - x) + (site_y - y) * (site_y - y);
      if (squared < found.nearest) {
        found.second = std::exchange(found.nearest, squared);
        found.site = static_cast<uint32_t>(hash >> 32);
      } else {
        found.second = std::min(found.second, squared);
      }
    }
  }
  found.nearest = std::sqrt(found.nearest);
  found.second = std::sqrt(found.second);
  return found;
}

float cosineOfTurns(float turns) {
  const float t = turns - std::floor(turns) - 0.5f;  // 0 where the cosine is -1
  const float x = 39.478418f * t * t;                // (2 pi t)^2
  // The power series to the tenth degree in t.
  return x * (0.5f - x * (1.0f / 24 - x * (1.0f / 720 - x * (1.0f / 40320 - x / 3628800)))) - 1.0f;
}

}  // namespace shoal::world
