// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/reef_fields.h"

#include <algorithm>

#include "shoal/random.h"
#include "shoal/world/noise.h"

namespace shoal::world {
namespace {

constexpr float kSpacing = 2.0f;  // metres between nodes: under half of the finest feature
constexpr int kNodes = static_cast<int>(ReefFields::kSide / kSpacing) + 1;
constexpr int kPeriod = 1 << 10;  // of noise, features: further than the reef is wide

/// Which noise is which; a number, once given, keeps its meaning.
enum Layer : uint64_t { kHeight = 1, kBorderX, kBorderY, kSunlight, kShade, kMix, kGround = 10 };

float smoothstep(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

}  // namespace

ReefFields::ReefFields(const ReefStyle& style, uint64_t seed)
    : key_(hashCombine(seed, style.salt)),
      terrain_(kNodes, kSpacing, [this](float x, float y) { return terrainAt(x, y); }),
      height_(kNodes, kSpacing,
              [this](float x, float y) {
                return std::array{std::clamp(0.9f * noise(kHeight, 30.0f, 3, x, y), -0.9f, 0.9f)};
              }),
      ground_(kNodes, kSpacing, [&](float x, float y) { return groundAt(style, x, y); }),
      light_(kNodes, kSpacing, [&](float x, float y) { return lightAt(style, x, y); }) {}

float ReefFields::noise(uint64_t layer, float width_m, int octaves, float x, float y) const {
  return fractalNoise(hashCombine(key_, layer), kPeriod, octaves, x / width_m, y / width_m);
}

std::array<float, 4> ReefFields::terrainAt(float x, float y) const {
  const float middle = 0.5f * kSide;
  const float east = smoothstep(-7.0f, 7.0f, x - middle + 24.0f * noise(kBorderX, 45.0f, 2, x, y));
  const float south = smoothstep(-7.0f, 7.0f, y - middle + 24.0f * noise(kBorderY, 45.0f, 2, x, y));
  return {(1 - east) * (1 - south), east * (1 - south), (1 - east) * south, east * south};
}

std::array<float, 4> ReefFields::groundAt(const ReefStyle& style, float x, float y) const {
  const std::array<float, 4> weights = terrain(x, y);
  std::array<float, 4> ground{};
  for (size_t k = 0; k < ground.size(); ++k) {
    for (size_t t = 0; t < weights.size(); ++t) ground[k] += weights[t] * style.terrains[t].ground[k];
    if (k > 0) ground[k] += 0.8f * noise(kGround + k, style.ground_width_m, 3, x, y);
  }
  return ground;
}

std::array<float, 4> ReefFields::lightAt(const ReefStyle& style, float x, float y) const {
  const std::array<float, 4> weights = terrain(x, y);
  float shaded_part = 0.0f;
  Color tint{};
  for (size_t t = 0; t < weights.size(); ++t) {
    shaded_part += weights[t] * style.terrains[t].shade;
    for (size_t c = 0; c < 3; ++c) tint[c] += weights[t] * style.terrains[t].tint[c];
  }
  const float threshold = 0.5f - shaded_part;
  const float shade = smoothstep(threshold - 0.05f, threshold + 0.07f, noise(kShade, 26.0f, 2, x, y));
  const float rise = height(x + kSpacing, y - kSpacing) - height(x - kSpacing, y + kSpacing);  // from the sun
  const float sunlight = 1.0f + 0.18f * noise(kSunlight, 60.0f, 2, x, y) + 0.25f * rise;
  const float brightness = sunlight * (1.0f - 0.45f * shade);
  // Shade is lit by the water above: bluer.
  return {brightness * tint[0] * (1.0f - 0.06f * shade), brightness * tint[1],
          brightness * tint[2] * (1.0f + 0.08f * shade), 1.1f * noise(kMix, 35.0f, 3, x, y)};
}

}  // namespace shoal::world
