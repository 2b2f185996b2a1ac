// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/reef_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "shoal/random.h"
#include "shoal/world/noise.h"

namespace shoal::world {
namespace {

constexpr int kNodes = static_cast<int>(ReefSurface::kSide) + 1;  // of the coarse maps, one per metre
constexpr int kBins = static_cast<int>(ReefSurface::kSide);       // per side, one per metre
constexpr int kPeriod = 1 << 10;                                  // of noise: further than the reef is wide

/// Where the shadow of a thing falls, per metre of its height: the sun stands in the south-west.
constexpr float kShadowX = 0.6f, kShadowY = 0.6f;

/// Purposes of random numbers and noise; a number, once given, keeps its meaning.
enum Layer : uint64_t {
  kHeight = 1,
  kKind = 10,
  kBorderX = 20,
  kBorderY,
  kSunlight,
  kShade,
  kMix,
  kTextures = 30,
  kThings = 40
};

float noise(uint64_t seed, uint64_t layer, float width_m, int octaves, float x, float y) {
  return fractalNoise(hashCombine(seed, layer), kPeriod, octaves, x / width_m, y / width_m);
}

float smoothstep(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

// In the maps y grows southwards from the north border, as rows of a picture do.

/// How much of each terrain there is; sums to 1. Borders wander about the middle.
std::array<float, 4> terrainWeights(uint64_t seed, float x, float y) {
  const float middle = 0.5f * ReefSurface::kSide;
  const float east = smoothstep(-7.0f, 7.0f, x - middle + 24.0f * noise(seed, kBorderX, 45.0f, 2, x, y));
  const float south = smoothstep(-7.0f, 7.0f, y - middle + 24.0f * noise(seed, kBorderY, 45.0f, 2, x, y));
  return {(1 - east) * (1 - south), east * (1 - south), (1 - east) * south, east * south};
}

float groundHeight(uint64_t seed, float x, float y) {
  return std::clamp(0.9f * noise(seed, kHeight, 30.0f, 3, x, y), -0.9f, 0.9f);
}

std::array<float, 4> groundKind(const ReefStyle& style, uint64_t seed, float x, float y) {
  const std::array<float, 4> weights = terrainWeights(seed, x, y);
  std::array<float, 4> kind{};
  for (size_t k = 0; k < kind.size(); ++k) {
    for (size_t t = 0; t < weights.size(); ++t) kind[k] += weights[t] * style.terrains[t].ground[k];
    if (k > 0) kind[k] += 0.8f * noise(seed, kKind + k, style.ground_width_m, 3, x, y);
  }
  return kind;
}

std::array<float, 4> light(const ReefStyle& style, uint64_t seed, float x, float y) {
  const std::array<float, 4> weights = terrainWeights(seed, x, y);
  float shaded_part = 0.0f;
  Color tint{};
  for (size_t t = 0; t < weights.size(); ++t) {
    shaded_part += weights[t] * style.terrains[t].shade;
    for (size_t c = 0; c < 3; ++c) tint[c] += weights[t] * style.terrains[t].tint[c];
  }
  const float threshold = 0.5f - shaded_part;
  const float shade = smoothstep(threshold - 0.05f, threshold + 0.07f, noise(seed, kShade, 26.0f, 2, x, y));
  const float slope = groundHeight(seed, x + 1, y - 1) - groundHeight(seed, x - 1, y + 1);
  const float sunlight = 1.0f + 0.18f * noise(seed, kSunlight, 60.0f, 2, x, y) - 0.5f * slope;
  const float brightness = sunlight * (1.0f - 0.45f * shade);
  // Shade is lit by the water above: bluer.
  return {brightness * tint[0] * (1.0f - 0.06f * shade), brightness * tint[1],
          brightness * tint[2] * (1.0f + 0.08f * shade), 1.1f * noise(seed, kMix, 35.0f, 3, x, y)};
}

}  // namespace

ReefSurface::ReefSurface(ReefStyle style, uint64_t seed)
    : style_(std::move(style)),
      ground_height_(
          kNodes,
          [&](float x, float y) { return std::array{groundHeight(hashCombine(seed, style_.salt), x, y)}; }),
      ground_kind_(
          kNodes, [&](float x, float y) { return groundKind(style_, hashCombine(seed, style_.salt), x, y); }),
      light_(kNodes, [&](float x, float y) { return light(style_, hashCombine(seed, style_.salt), x, y); }),
      edges_(Texture::kEdge, hashCombine(seed, style_.salt)) {
  const uint64_t key = hashCombine(seed, style_.salt);
  for (const ReefClass& c : style_.classes) textures_.emplace_back(c.texture, hashCombine(key, kTextures));
  plant(key);
}

void ReefSurface::plant(uint64_t seed) {
  std::vector<Thing> planted;
  for (size_t t = 0; t < style_.terrains.size(); ++t) {
    const std::vector<Growth>& growths = style_.terrains[t].growths;
    for (size_t g = 0; g < growths.size(); ++g) {
      const Growth& growth = growths[g];
      Random random(hashCombine(seed, kThings), t, g);
      const auto between = [&](float low, float high) {
        return low + (high - low) * static_cast<float>(random.uniform());
      };
      // Radii are the smaller of two draws: many small, few large; E[r^2] of that law.
      const float spread = growth.max_radius_m - growth.min_radius_m;
      const float mean_square = growth.min_radius_m * growth.min_radius_m +
                                2.0f / 3.0f * growth.min_radius_m * spread + spread * spread / 6.0f;
      const float covered =
          growth.share * kSide * kSide;  // by colonies anywhere; other terrains' are left out
      const int colonies = static_cast<int>(
          covered / (std::numbers::pi_v<float> * mean_square * static_cast<float>(growth.colony)));
      for (int i = 0; i < colonies; ++i) {
        const float x = between(0.0f, kSide), y = between(0.0f, kSide);
        const bool belongs = terrainWeights(seed, x, y)[t] > 0.5f;
        const float width = 1.1f * growth.max_radius_m * std::sqrt(static_cast<float>(growth.colony));
        for (int member = 0; member < growth.colony; ++member) {
          const float radius = std::min(between(growth.min_radius_m, growth.max_radius_m),
                                        between(growth.min_radius_m, growth.max_radius_m));
          const float turn = between(0.0f, std::numbers::pi_v<float>), narrow = between(0.75f, 1.0f);
          Thing thing;
          thing.x = x + between(-0.5f, 0.5f) * width + between(-0.5f, 0.5f) * width;
          thing.y = y + between(-0.5f, 0.5f) * width + between(-0.5f, 0.5f) * width;
          thing.xx = std::cos(turn) / radius;
          thing.xy = std::sin(turn) / radius;
          thing.yx = -std::sin(turn) / (narrow * radius);
          thing.yy = std::cos(turn) / (narrow * radius);
          thing.reach = kReach * radius;
          thing.height = radius * growth.height * between(0.6f, 1.0f);
          thing.roughness = growth.roughness;
          thing.mix = between(-0.8f, 0.8f);
          thing.label = growth.label;
          if (belongs) planted.push_back(thing);
        }
      }
    }
  }
  sortIntoBins(planted);
}

void ReefSurface::sortIntoBins(const std::vector<Thing>& planted) {
  std::vector<std::vector<Thing>> bins(static_cast<size_t>(kBins) * kBins);
  for (const Thing& thing : planted) {
    const auto bin = [](float p) { return static_cast<int>(std::clamp(std::floor(p), 0.0f, kSide - 1.0f)); };
    // With its shadow: north is towards smaller y.
    for (int y = bin(thing.y - thing.reach - kShadowY * thing.height); y <= bin(thing.y + thing.reach); ++y) {
      for (int x = bin(thing.x - thing.reach); x <= bin(thing.x + thing.reach + kShadowX * thing.height);
           ++x) {
        bins[static_cast<size_t>(y * kBins + x)].push_back(thing);
      }
    }
  }
  for (const std::vector<Thing>& bin : bins) {
    first_in_bin_.push_back(static_cast<int32_t>(things_.size()));
    things_.insert(things_.end(), bin.begin(), bin.end());
  }
  first_in_bin_.push_back(static_cast<int32_t>(things_.size()));
}

std::span<const ReefSurface::Thing> ReefSurface::thingsNear(float x, float y) const {
  if (!(x >= 0.0f && x < kSide && y >= 0.0f && y < kSide)) return {};
  const size_t bin = static_cast<size_t>(static_cast<int>(y) * kBins + static_cast<int>(x));
  return {things_.data() + first_in_bin_[bin], things_.data() + first_in_bin_[bin + 1]};
}

float ReefSurface::heightAt(float x, float y) const {
  float bump = 0.0f;
  for (const Thing& thing : thingsNear(x, -y)) {
    const auto [u, v] = thing.inRadii(x, -y);
    const float inside = 1.0f - (u * u + v * v) / (kReach * kReach);
    if (inside > 0.0f) bump = std::max(bump, thing.height * inside * inside);
  }
  return ground_height_.at(x, -y)[0] + bump;
}

SeabedPoint ReefSurface::at(float x, float y) const {
  const float south = -y;
  const TextureTile::Sample edge = edges_.at(x, south);
  const std::array<float, 4> light = light_.at(x, south);

  // The thing deepest inside whose outline the point lies, else the ground and what shadows fall on it.
  const Thing* on = nullptr;
  float depth_inside = 0.0f, lit = 1.0f, shadow = 0.0f;
  for (const Thing& thing : thingsNear(x, south)) {
    const auto [u, v] = thing.inRadii(x, south);
    const float squared = u * u + v * v;
    if (squared < kReach * kReach) {
      const float inside = 1.0f - std::sqrt(squared) - thing.roughness * 0.5f * (edge.brightness + edge.mix);
      if (inside > depth_inside) {
        depth_inside = inside;
        on = &thing;
        // How the bump rises away from the sun, in the south-west.
        const float rise = 4.0f * thing.height / (kReach * kReach) * (1.0f - squared / (kReach * kReach));
        const float south_west = (thing.xy - thing.xx) * u + (thing.yy - thing.yx) * v;
        lit = 1.0f + 0.45f * rise * south_west;
      }
    }
    const auto [shadow_u, shadow_v] =
        thing.inRadii(x - kShadowX * thing.height, south + kShadowY * thing.height);
    const float away = shadow_u * shadow_u + shadow_v * shadow_v;
    shadow = std::max(shadow, 1.3f - away);
  }

  SeabedPoint point;
  float mix = light[3];
  if (on != nullptr) {
    point.label = on->label;
    mix = 0.5f * mix + on->mix;
    lit *= 0.72f + 0.28f * std::min(1.0f, 4.0f * depth_inside);  // rims lie low, between neighbours
  } else {
    std::array<float, 4> kind = ground_kind_.at(x, south);
    kind[1] += 0.22f * edge.brightness;
    kind[2] += 0.30f * edge.mix;
    kind[3] -= 0.18f * edge.brightness;
    point.label =
        style_.ground[static_cast<size_t>(std::max_element(kind.begin(), kind.end()) - kind.begin())];
    lit -= 0.5f * std::min(1.0f, std::max(0.0f, shadow * 1.6f));
  }

  const ReefClass& c = style_.classes[point.label];
  const TextureTile::Sample surface = textures_[point.label].at(x, south);
  const float second = std::clamp(0.5f + 0.5f * mix + 0.4f * surface.mix, 0.0f, 1.0f);
  const float brightness = lit * (1.0f + c.contrast * surface.brightness);
  for (size_t i = 0; i < 3; ++i) {
    point.color[i] = light[i] * brightness * (c.first[i] + (c.second[i] - c.first[i]) * second);
  }
  return point;
}

}  // namespace shoal::world
