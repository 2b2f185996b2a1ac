// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "shoal/world/coarse_map.h"
#include "shoal/world/reef_style.h"

namespace shoal::world {

/// What changes slowly over a reef: which terrain, how high, which ground, how much light. A pure function of
/// style and seed, kept as maps with a node every 2 m (heights: every half metre).
///
/// Coordinates are metres from the north-west corner, x to the east and y to the SOUTH, as in a picture;
/// outside the square, of its nearest border.
class ReefFields {
 public:
  static constexpr float kSide = 250.0f;                    ///< of the square, metres
  static constexpr float kHeightSpacing = 0.5f;             ///< metres between nodes of the ground's mesh
  static constexpr float kLowest = -1.6f, kHighest = 1.6f;  ///< bounds of the ground, metres

  /// What lies and falls on the ground at a point.
  struct Ground {
    std::array<float, 4> kinds;  ///< how much more than sand of each of ReefStyle::ground; the greatest wins
    Color tint;                  ///< of the light, about 1
    float sun;                   ///< part of the sun that gets here, [0, 1.2]
    float mix;                   ///< to which of its two colours a thing tends here, about [-1, 1]
  };

  struct Relief {
    float height, rise_x, rise_y;  ///< metres; slopes towards x and y
  };

  ReefFields(const ReefStyle& style, uint64_t seed);

  /// What all random numbers of this place begin with.
  uint64_t key() const { return key_; }

  /// Parts of ReefStyle::terrains, summing to 1. Borders wander about the middle lines.
  std::array<float, 4> terrain(float x, float y) const { return terrain_.at(x, y); }

  /// Height over Z = 0 and slopes, smoothed over half a metre.
  Relief relief(float x, float y) const {
    const auto [height, rise_x, rise_y, unused] = relief_.at(x, y);
    return {height, rise_x, rise_y};
  }
  /// The height at a node of the mesh, 0 <= x, y < meshNodes().
  float meshHeight(int x, int y) const { return relief_.node(x, y)[0]; }
  int meshNodes() const { return relief_.nodes(); }

  Ground ground(float x, float y) const {
    const auto g = ground_.at(x, y);
    return {{0.0f, g[0], g[1], g[2]}, {g[3], g[4], g[5]}, g[6], g[7]};
  }

  /// To which of its two colours, and to which of its shapes, a class tends here; about [-1, 1].
  float habit(uint8_t label, float x, float y) const;

 private:
  std::array<float, 4> terrainAt(float x, float y) const;
  float heightAt(const ReefStyle& style, float x, float y) const;
  std::array<float, 8> groundAt(const ReefStyle& style, float x, float y) const;
  float noise(uint64_t layer, float width_m, int octaves, float x, float y) const;

  uint64_t key_;
  CoarseMap<4> terrain_;
  CoarseMap<4> relief_;  // height, slopes, 0
  CoarseMap<8> ground_;
};

}  // namespace shoal::world
