// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "shoal/world/coarse_map.h"
#include "shoal/world/reef_style.h"

namespace shoal::world {

/// What changes slowly over a reef: which terrain, how high, which ground, how much light. A pure function of
/// style and seed, kept as maps with a node every 2 m.
///
/// Coordinates are metres from the north-west corner, x to the east and y to the SOUTH, as in a picture;
/// outside the square, of its nearest border.
class ReefFields {
 public:
  static constexpr float kSide = 250.0f;  ///< of the square, metres

  struct Light {
    Color color;  ///< sun and shade, about 1
    float mix;    ///< to which of its two colours a thing tends here, about [-1, 1]
  };

  ReefFields(const ReefStyle& style, uint64_t seed);

  /// What all random numbers of this place begin with.
  uint64_t key() const { return key_; }

  /// Parts of ReefStyle::terrains, summing to 1. Borders wander about the middle lines.
  std::array<float, 4> terrain(float x, float y) const { return terrain_.at(x, y); }

  /// Height of the bare ground over Z = 0, within 0.9 m of it.
  float height(float x, float y) const { return height_.at(x, y)[0]; }

  /// How much there is of each of ReefStyle::ground; the greatest wins.
  std::array<float, 4> ground(float x, float y) const { return ground_.at(x, y); }

  Light light(float x, float y) const {
    const std::array<float, 4> light = light_.at(x, y);
    return {{light[0], light[1], light[2]}, light[3]};
  }

 private:
  std::array<float, 4> terrainAt(float x, float y) const;
  std::array<float, 4> groundAt(const ReefStyle& style, float x, float y) const;
  std::array<float, 4> lightAt(const ReefStyle& style, float x, float y) const;
  float noise(uint64_t layer, float width_m, int octaves, float x, float y) const;

  uint64_t key_;
  CoarseMap<4> terrain_;
  CoarseMap<1> height_;
  CoarseMap<4> ground_;
  CoarseMap<4> light_;
};

}  // namespace shoal::world
