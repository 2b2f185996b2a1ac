// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/texture_tile.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shoal/demand.h"
#include "shoal/random.h"
#include "shoal/world/noise.h"

namespace shoal::world {
namespace {

/// Noise over one tile, in units of a feature `width_m` wide (rounded so that it repeats with the tile).
class Canvas {
 public:
  Canvas(uint64_t seed, float side_m, float x_m, float y_m)
      : seed_(seed), side_m_(side_m), x_m_(x_m), y_m_(y_m) {}

  float noise(uint64_t layer, float width_m, int octaves, float shift_m = 0.0f) const {
    const int period = periodOf(width_m);
    const float scale = static_cast<float>(period) / side_m_;
    return fractalNoise(hashCombine(seed_, layer), period, octaves, (x_m_ + shift_m) * scale,
                        (y_m_ + shift_m) * scale);
  }

  SiteDistances sites(uint64_t layer, float width_m, float warp_m = 0.0f) const {
    const int period = periodOf(width_m);
    const float scale = static_cast<float>(period) / side_m_;
    const float dx = warp_m == 0.0f ? 0.0f : warp_m * noise(layer + 100, 3.0f * width_m, 1);
    const float dy = warp_m == 0.0f ? 0.0f : warp_m * noise(layer + 200, 3.0f * width_m, 1);
    return cellularNoise(hashCombine(seed_, layer), period, (x_m_ + dx) * scale, (y_m_ + dy) * scale);
  }

  /// cos of a wave that runs `count_x`, `count_y` times over the tile, pushed by `phase` turns.
  float wave(int count_x, int count_y, float phase) const {
    const float turns =
        (static_cast<float>(count_x) * x_m_ + static_cast<float>(count_y) * y_m_) / side_m_ + phase;
    return std::cos(2.0f * std::numbers::pi_v<float> * turns);
  }

  /// How much brighter a bump is on the side that faces the sun than on the other.
  float relief(uint64_t layer, float width_m, int octaves) const {
    constexpr float kStep = 0.03f;
    return noise(layer, width_m, octaves, kStep) - noise(layer, width_m, octaves, -kStep);
  }

 private:
  int periodOf(float width_m) const { return std::max(1, static_cast<int>(std::lround(side_m_ / width_m))); }

  uint64_t seed_;
  float side_m_, x_m_, y_m_;
};

float siteShade(uint32_t site) { return static_cast<float>(site & 0xffff) * 0x1p-15f - 1.0f; }

TextureTile::Sample paint(Texture texture, const Canvas& c) {
  switch (texture) {
    case Texture::kSand: {  // ripples that come and go, grain
      const float ripples =
          c.wave(18, 43, 2.2f * c.noise(1, 3.0f, 2)) * std::max(0.0f, 0.35f + c.noise(2, 5.0f, 2));
      return {0.55f * ripples + 0.35f * c.noise(3, 0.16f, 2), c.noise(4, 1.5f, 3)};
    }
    case Texture::kRubble: {  // broken pieces, each of its own grey
      const SiteDistances s = c.sites(1, 0.32f, 0.1f);
      const float piece = std::min(1.0f, 4.0f * (s.second - s.nearest));
      return {piece * (0.35f + 0.55f * siteShade(s.site)) - 0.65f * (1.0f - piece),
              siteShade(static_cast<uint32_t>(mix64(s.site)))};
    }
    case Texture::kRock: {  // ledges lit from one side, cracks
      const SiteDistances s = c.sites(1, 1.3f, 0.5f);
      const float crack = std::min(1.0f, 7.0f * (s.second - s.nearest));
      return {1.4f * c.relief(2, 0.7f, 4) + 0.25f * siteShade(s.site) - 0.6f * (1.0f - crack) +
                  0.2f * c.noise(5, 0.5f, 3),
              c.noise(3, 0.9f, 3)};
    }
    case Texture::kSeagrass: {  // blades: stripes that waver, bare gaps
      const float sway = c.noise(1, 0.9f, 2);
      const float blades = c.wave(31, 13, 2.5f * sway + 1.2f * c.noise(2, 0.2f, 1));
      return {0.5f * blades + 0.5f * c.noise(3, 0.18f, 2), 0.8f * c.noise(4, 0.6f, 2) - 0.3f * blades};
    }
    case Texture::kAlgae:  // clumps
      return {0.9f * c.noise(1, 0.45f, 3) + 0.5f * c.relief(2, 0.25f, 2), 1.3f * c.noise(3, 0.7f, 2)};
    case Texture::kBrainCoral: {  // winding grooves
      const float grooves = std::cos(9.0f * c.noise(1, 0.55f, 2));
      return {0.45f * grooves + 0.5f * c.relief(2, 1.0f, 2), 0.6f * grooves + 0.4f * c.noise(3, 1.2f, 2)};
    }
    case Texture::kBranchingCoral: {  // bright tips over dark gaps
      const SiteDistances s = c.sites(1, 0.2f);
      return {0.8f - 1.7f * s.nearest + 0.2f * siteShade(s.site),
              0.7f - 1.5f * s.nearest + 0.3f * c.noise(2, 1.0f, 2)};
    }
    case Texture::kPlateCoral: {  // overlapping plates with pale rims
      const SiteDistances s = c.sites(1, 0.75f, 0.1f);
      const float rings = std::cos(16.0f * s.nearest);
      const float rim = std::max(0.0f, 1.0f - 5.0f * (s.second - s.nearest));
      return {0.3f * siteShade(s.site) + 0.25f * rings + 0.6f * rim - 0.25f, 0.5f * siteShade(s.site) + rim};
    }
    case Texture::kSponge: {  // lobes with dark pores
      const SiteDistances s = c.sites(1, 0.36f, 0.15f);
      const float pore = s.nearest < 0.18f ? -0.8f : 0.0f;
      return {0.35f - 0.6f * s.nearest + pore + 0.3f * c.relief(2, 0.8f, 2), c.noise(3, 0.8f, 3)};
    }
    case Texture::kEdge:  // not a surface: how far borders wander
      return {1.2f * c.noise(1, 1.3f, 4), 1.2f * c.noise(2, 2.6f, 4)};
  }
  SHOAL_DEMAND(false && "every texture is painted");
}

}  // namespace

TextureTile::TextureTile(Texture texture, uint64_t seed) {
  // Ground fills whole frames (12.8 m) and must not be seen to repeat; things are smaller than a tile.
  const bool is_ground = texture == Texture::kSand || texture == Texture::kEdge;
  const int size = is_ground ? 512 : 256;
  mask_ = size - 1;
  texels_.resize(static_cast<size_t>(size) * static_cast<size_t>(size));
  const auto quantize = [](float value) {
    return static_cast<int8_t>(std::lround(127.0f * std::clamp(value, -1.0f, 1.0f)));
  };
  const uint64_t key = hashCombine(seed, static_cast<uint64_t>(texture));
  const float side_m = static_cast<float>(size) / kTexelsPerMetre;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const Canvas canvas(key, side_m, static_cast<float>(x) / kTexelsPerMetre,
                          static_cast<float>(y) / kTexelsPerMetre);
      const Sample sample = paint(texture, canvas);
      texels_[static_cast<size_t>(y) * side() + static_cast<size_t>(x)] = {quantize(sample.brightness),
                                                                           quantize(sample.mix)};
    }
  }
}

}  // namespace shoal::world
