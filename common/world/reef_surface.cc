// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/reef_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "shoal/random.h"

namespace shoal::world {
namespace {

constexpr int kBins = static_cast<int>(ReefSurface::kSide);  // per side, one per metre

/// Of a coordinate; beyond the square, the outermost.
int binOf(float p) { return static_cast<int>(std::clamp(p, 0.0f, ReefSurface::kSide - 1.0f)); }

/// Where the shadow of a thing falls, per metre of its height: the sun stands in the south-west.
constexpr float kShadowX = 0.6f, kShadowY = 0.6f;

}  // namespace

ReefSurface::ReefSurface(ReefStyle style, uint64_t seed)
    : style_(std::move(style)), fields_(style_, seed), edges_(Texture::kEdge, fields_.key()) {
  for (const ReefClass& c : style_.classes) textures_.emplace_back(c.texture, fields_.key());
  plant();
}

void ReefSurface::plant() {
  std::vector<Thing> planted;
  for (size_t t = 0; t < style_.terrains.size(); ++t) {
    const std::vector<Growth>& growths = style_.terrains[t].growths;
    for (size_t g = 0; g < growths.size(); ++g) {
      const Growth& growth = growths[g];
      Random random(fields_.key(), t, g);
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
        const bool belongs = fields_.terrain(x, y)[t] > 0.5f;
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
    // With its shadow: north is towards smaller y.
    for (int y = binOf(thing.y - thing.reach - kShadowY * thing.height); y <= binOf(thing.y + thing.reach);
         ++y) {
      for (int x = binOf(thing.x - thing.reach); x <= binOf(thing.x + thing.reach + kShadowX * thing.height);
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
  const size_t bin = static_cast<size_t>(binOf(y) * kBins + binOf(x));
  return {things_.data() + first_in_bin_[bin], things_.data() + first_in_bin_[bin + 1]};
}

float ReefSurface::heightAt(float x, float y) const {
  float bump = 0.0f;
  for (const Thing& thing : thingsNear(x, -y)) {
    const auto [u, v] = thing.inRadii(x, -y);
    const float inside = 1.0f - (u * u + v * v) / (kReach * kReach);
    if (inside > 0.0f) bump = std::max(bump, thing.height * inside * inside);
  }
  return fields_.height(x, -y) + bump;
}

SeabedPoint ReefSurface::at(float x, float y) const {
  const float south = -y;
  const TextureTile::Sample edge = edges_.at(x, south);
  const ReefFields::Light light = fields_.light(x, south);

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
  float mix = light.mix;
  if (on != nullptr) {
    point.label = on->label;
    mix = 0.5f * mix + on->mix;
    lit *= 0.72f + 0.28f * std::min(1.0f, 4.0f * depth_inside);  // rims lie low, between neighbours
  } else {
    std::array<float, 4> kind = fields_.ground(x, south);
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
    point.color[i] = light.color[i] * brightness * (c.first[i] + (c.second[i] - c.first[i]) * second);
  }
  return point;
}

}  // namespace shoal::world
