// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/texture_tile.h"

#include <algorithm>
#include <cmath>

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

  float noise(uint64_t layer, float width_m, int octaves) const {
    const int period = periodOf(width_m);
    const float scale = static_cast<float>(period) / side_m_;
    return fractalNoise(hashCombine(seed_, layer), period, octaves, x_m_ * scale, y_m_ * scale);
  }

  SiteDistances sites(uint64_t layer, float width_m, float warp_m = 0.0f) const {
    const int period = periodOf(width_m);
    const float scale = static_cast<float>(period) / side_m_;
    const float dx = warp_m == 0.0f ? 0.0f : warp_m * noise(layer + 100, 3.0f * width_m, 1);
    const float dy = warp_m == 0.0f ? 0.0f : warp_m * noise(layer + 200, 3.0f * width_m, 1);
    return cellularNoise(hashCombine(seed_, layer), period, (x_m_ + dx) * scale, (y_m_ + dy) * scale);
  }

  /// A wave that runs `count_x`, `count_y` times over the tile, pushed by `phase` turns.
  float wave(int count_x, int count_y, float phase) const {
    return cosineOfTurns((static_cast<float>(count_x) * x_m_ + static_cast<float>(count_y) * y_m_) / side_m_ +
                         phase);
  }

 private:
  int periodOf(float width_m) const { return std::max(1, static_cast<int>(std::lround(side_m_ / width_m))); }

  uint64_t seed_;
  float side_m_, x_m_, y_m_;
};

struct Paint {
  float brightness, mix;
  float height_m = 0.0f;
};

float siteShade(uint32_t site) { return static_cast<float>(site & 0xffff) * 0x1p-15f - 1.0f; }

Paint paint(Texture texture, const Canvas& c) {
  switch (texture) {
    case Texture::kSand: {  // ripples that come and go, grain, specks of shell
      const float strength = std::clamp(0.45f + 1.2f * c.noise(2, 5.0f, 2), 0.0f, 1.0f);
      const float ripples = c.wave(21, 52, 2.4f * c.noise(1, 4.0f, 3)) * strength;
      const float grain = c.noise(3, 0.16f, 2);
      const float specks = std::max(0.0f, c.noise(5, 0.12f, 1) - 0.62f);
      return {0.16f * ripples + 0.4f * grain + 1.6f * specks, c.noise(4, 1.5f, 3),
              0.020f * ripples + 0.05f * c.noise(6, 0.9f, 2)};
    }
    case Texture::kRubble: {  // broken pieces, each of its own grey, over each other
      const SiteDistances s = c.sites(1, 0.30f, 0.1f), t = c.sites(2, 0.16f, 0.05f);
      const float piece = std::min(1.0f, 3.5f * (s.second - s.nearest));
      const float chips = std::min(1.0f, 3.0f * (t.second - t.nearest));
      return {piece * (0.15f + 0.45f * siteShade(s.site) + 0.25f * siteShade(t.site) * chips) -
                  0.7f * (1.0f - piece),
              siteShade(static_cast<uint32_t>(mix64(s.site))), 0.05f * piece + 0.02f * chips};
    }
    case Texture::kRock: {  // ledges, cracks, a film of what grows
      const SiteDistances s = c.sites(1, 1.5f, 0.6f);
      const float crack = std::min(1.0f, 7.0f * (s.second - s.nearest));
      const float rough = c.noise(2, 0.8f, 4);
      return {0.25f * siteShade(s.site) - 0.6f * (1.0f - crack) + 0.9f * rough, 1.2f * c.noise(3, 1.1f, 3),
              0.16f * rough + 0.05f * crack};
    }
    case Texture::kSeagrass: {  // blades that lie in the current, bare gaps
      const float sway = c.noise(1, 1.1f, 2);
      const float blades = c.wave(41, 17, 2.6f * sway + 1.2f * c.noise(2, 0.22f, 1));
      const float tufts = c.noise(3, 0.5f, 3);
      return {0.35f * blades + 0.75f * tufts, 0.9f * c.noise(4, 0.7f, 2) - 0.35f * blades,
              0.03f * blades + 0.10f * tufts};
    }
    case Texture::kAlgae: {  // clumps
      const float clumps = c.noise(1, 0.4f, 3);
      return {0.9f * clumps, 1.3f * c.noise(3, 0.7f, 2), 0.10f * clumps};
    }
    case Texture::kBrainCoral: {  // winding grooves, knobs, worn patches
      const float grooves = cosineOfTurns(2.5f * c.noise(1, 0.36f, 2));
      const float knobs = c.noise(4, 0.3f, 2), worn = c.noise(2, 0.8f, 3);
      return {0.35f * grooves + 0.4f * knobs + 0.5f * worn, 0.3f * grooves + 0.9f * c.noise(3, 0.7f, 3),
              0.012f * grooves + 0.06f * knobs};
    }
    case Texture::kBranchingCoral: {  // polyps along the branches
      const SiteDistances s = c.sites(1, 0.14f);
      return {0.45f - 1.1f * s.nearest + 0.3f * c.noise(3, 0.5f, 2),
              0.8f * c.noise(2, 1.0f, 2) - s.nearest + 0.5f, 0.02f * (1.0f - s.nearest)};
    }
    case Texture::kPlateCoral: {  // fine ridges that wander, pale growing patches
      const float ridges = cosineOfTurns(4.0f * c.noise(1, 0.7f, 3)), patches = c.noise(3, 0.6f, 2);
      return {0.35f * ridges + 0.45f * c.noise(2, 0.2f, 2) + 0.35f * patches, 0.3f * ridges + 1.1f * patches,
              0.015f * ridges};
    }
    case Texture::kSponge: {  // ribs and pores
      const SiteDistances s = c.sites(1, 0.17f, 0.05f);
      const float pore = s.nearest < 0.3f ? -0.7f : 0.15f;
      return {pore + 0.5f * c.noise(2, 0.6f, 2), c.noise(3, 0.8f, 3), 0.03f * s.nearest};
    }
    case Texture::kEdge:
      return {1.2f * c.noise(1, 1.3f, 4), 1.2f * c.noise(2, 2.6f, 4)};
    case Texture::kCaustics: {  // where waves focus the light: a broken net of soft lines
      const SiteDistances s = c.sites(1, 1.5f, 0.9f), t = c.sites(2, 0.9f, 0.6f);
      const auto line = [](const SiteDistances& d) {
        const float dark = std::min(1.0f, 1.7f * (d.second - d.nearest));
        return (1.0f - dark) * (1.0f - dark);
      };
      const float broken = 0.5f + 0.9f * c.noise(3, 1.8f, 2), other = 0.5f - 0.9f * c.noise(3, 1.8f, 2);
      return {0.7f * line(s) * std::max(0.0f, broken) + 0.5f * line(t) * std::max(0.0f, other) - 0.2f, 0.0f};
    }
  }
  SHOAL_DEMAND(false && "every texture is painted");
}

uint64_t quantize(float value) {
  return static_cast<uint64_t>(128 + std::lround(127.0f * std::clamp(value, -1.0f, 1.0f)));
}

}  // namespace

TextureTile::TextureTile(Texture texture, uint64_t seed) {
  // Ground fills whole frames (12.8 m) and must not be seen to repeat; things are smaller than a tile.
  const bool is_ground = texture == Texture::kSand || texture == Texture::kEdge;
  const int size = is_ground ? 512 : 256;
  mask_ = static_cast<uint32_t>(size - 1);
  const uint64_t key = hashCombine(seed, static_cast<uint64_t>(texture));
  const float side_m = static_cast<float>(size) / kTexelsPerMetre;
  std::vector<Paint> painted;
  painted.reserve(static_cast<size_t>(size) * static_cast<size_t>(size));
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      painted.push_back(paint(texture, Canvas(key, side_m, static_cast<float>(x) / kTexelsPerMetre,
                                              static_cast<float>(y) / kTexelsPerMetre)));
    }
  }
  const auto at = [&](int x, int y) -> const Paint& {
    return painted[(static_cast<uint32_t>(y) & mask_) * side() + (static_cast<uint32_t>(x) & mask_)];
  };
  const auto rise = [](const Paint& from, const Paint& to) {
    return quantize(0.5f * kTexelsPerMetre * (to.height_m - from.height_m));
  };
  texels_.reserve(painted.size());
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      texels_.push_back(quantize(at(x, y).brightness) | quantize(at(x, y).mix) << 16 |
                        rise(at(x - 1, y), at(x + 1, y)) << 32 | rise(at(x, y - 1), at(x, y + 1)) << 48);
    }
  }
}

}  // namespace shoal::world
