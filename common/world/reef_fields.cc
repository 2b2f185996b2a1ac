// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/reef_fields.h"

#include <algorithm>

#include "shoal/random.h"
#include "shoal/world/noise.h"

namespace shoal::world {
namespace {

constexpr float kSpacing = 2.0f;  // metres between nodes: under half of the finest feature
constexpr int kNodes = static_cast<int>(ReefFields::kSide / kSpacing) + 1;
constexpr int kMeshNodes = static_cast<int>(ReefFields::kSide / ReefFields::kHeightSpacing) + 1;
constexpr int kPeriod = 1 << 10;  // of noise, features: further than the reef is wide

/// Which noise is which; a number, once given, keeps its meaning.
enum Layer : uint64_t {
  kSwell = 1,
  kBorderX,
  kBorderY,
  kSunlight,
  kShade,
  kMix,
  kRough,
  kLedge,
  kGround = 20,
  kHabit = 40
};

float smoothstep(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

}  // namespace

ReefFields::ReefFields(const ReefStyle& style, uint64_t seed)
    : key_(hashCombine(seed, style.salt)),
      terrain_(kNodes, kSpacing, [this](float x, float y) { return terrainAt(x, y); }),
      relief_(2, 1.0f, [](float, float) { return std::array<float, 4>{}; }),
      ground_(kNodes, kSpacing, [&](float x, float y) { return groundAt(style, x, y); }) {
  const CoarseMap<1> heights(kMeshNodes, kHeightSpacing,
                             [&](float x, float y) { return std::array{heightAt(style, x, y)}; });
  relief_ = CoarseMap<4>(kMeshNodes, kHeightSpacing, [&](float x, float y) {
    const auto rise = [&](float dx, float dy) {
      return (heights.at(x + dx, y + dy)[0] - heights.at(x - dx, y - dy)[0]) / (2.0f * kHeightSpacing);
    };
    return std::array{heights.at(x, y)[0], rise(kHeightSpacing, 0.0f), rise(0.0f, kHeightSpacing), 0.0f};
  });
}

float ReefFields::noise(uint64_t layer, float width_m, int octaves, float x, float y) const {
  return fractalNoise(hashCombine(key_, layer), kPeriod, octaves, x / width_m, y / width_m);
}

float ReefFields::habit(uint8_t label, float x, float y) const {
  return 1.3f * noise(kHabit + label, 45.0f, 2, x, y);
}

std::array<float, 4> ReefFields::terrainAt(float x, float y) const {
  const float middle = 0.5f * kSide;
  const float east = smoothstep(-7.0f, 7.0f, x - middle + 24.0f * noise(kBorderX, 45.0f, 2, x, y));
  const float south = smoothstep(-7.0f, 7.0f, y - middle + 24.0f * noise(kBorderY, 45.0f, 2, x, y));
  return {(1 - east) * (1 - south), east * (1 - south), (1 - east) * south, east * south};
}

float ReefFields::heightAt(const ReefStyle& style, float x, float y) const {
  const std::array<float, 4> weights = terrain(x, y);
  float swell = 0.0f, rough = 0.0f, ledge = 0.0f;
  for (size_t t = 0; t < weights.size(); ++t) {
    swell += weights[t] * style.terrains[t].swell_m;
    rough += weights[t] * style.terrains[t].rough_m;
    ledge += weights[t] * style.terrains[t].ledge_m;
  }
  const float step = smoothstep(-0.05f, 0.05f, noise(kLedge, 16.0f, 3, x, y)) - 0.5f;
  const float height =
      swell * noise(kSwell, 40.0f, 2, x, y) + rough * noise(kRough, 9.0f, 3, x, y) + ledge * step;
  return std::clamp(height, kLowest, kHighest);
}

std::array<float, 8> ReefFields::groundAt(const ReefStyle& style, float x, float y) const {
  const std::array<float, 4> weights = terrain(x, y);
  std::array<float, 8> ground{};
  auto& [kind_1, kind_2, kind_3, red, green, blue, sun, mix] = ground;
  float shaded_part = 0.0f;
  for (size_t t = 0; t < weights.size(); ++t) {
    const Terrain& terrain = style.terrains[t];
    shaded_part += weights[t] * terrain.shade;
    kind_1 += weights[t] * (terrain.ground[1] - terrain.ground[0]);
    kind_2 += weights[t] * (terrain.ground[2] - terrain.ground[0]);
    kind_3 += weights[t] * (terrain.ground[3] - terrain.ground[0]);
    red += weights[t] * terrain.tint[0];
    green += weights[t] * terrain.tint[1];
    blue += weights[t] * terrain.tint[2];
  }
  kind_1 += 0.8f * noise(kGround + 1, style.ground_width_m, 3, x, y);
  kind_2 += 0.8f * noise(kGround + 2, style.ground_width_m, 3, x, y);
  kind_3 += 0.8f * noise(kGround + 3, style.ground_width_m, 3, x, y);
  const float threshold = 0.5f - shaded_part;
  const float shade = smoothstep(threshold - 0.06f, threshold + 0.10f, noise(kShade, 26.0f, 3, x, y));
  sun = (1.0f + 0.15f * noise(kSunlight, 60.0f, 2, x, y)) * (1.0f - 0.72f * shade);
  mix = 1.5f * noise(kMix, 30.0f, 4, x, y);
  return ground;
}

}  // namespace shoal::world
