// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "shoal/world/texture_tile.h"
#include "shoal/world/world.h"

namespace shoal::world {

/// Red, green, blue; 0 to about 1 in full light, before the water takes its part.
using Color = std::array<float, 3>;

/// A class and how it looks: colours between `first` and `second`, `contrast` (0 to 1) of its texture.
struct ReefClass {
  TruthClass truth;
  Texture texture = Texture::kSand;
  Color first{}, second{};
  float contrast = 0.3f;
};

/// Things of one class that stand on the ground.
struct Growth {
  uint8_t label = 0;
  float share = 0.0f;  ///< of the terrain's area, [0, 1), before overlaps
  float min_radius_m = 0.4f, max_radius_m = 2.0f;
  float height = 0.3f;     ///< over radius, <= 0.42: a view from above hides nothing
  float roughness = 0.2f;  ///< of the outline over radius, <= 0.4
  int colony = 4;          ///< how many stand together
};

/// What a part of the reef is like.
struct Terrain {
  std::array<float, 4> ground{};  ///< how much of each of ReefStyle::ground: about [-1, 1], the greatest wins
  Color tint{1.0f, 1.0f, 1.0f};   ///< of the light
  float shade = 0.5f;             ///< part that lies in shadow, [0, 1]
  std::vector<Growth> growths;
};

/// Everything that makes one procedural reef differ from another, but for the seed.
struct ReefStyle {
  std::string name;                 ///< "reef:sparse"
  uint64_t salt = 0;                ///< keeps styles apart at equal seeds
  std::vector<ReefClass> classes;   ///< index = label
  std::array<uint8_t, 4> ground{};  ///< labels of what covers the ground, plain sand first
  float ground_width_m = 20.0f;     ///< of patches of ground
  std::array<Terrain, 4> terrains;  ///< north-west, north-east, south-west, south-east
};

/// reef:sparse: uniform sand in light and shade, few corals (paper, environment 1). reef:varied: other ground
/// and other species in each quarter (environment 2). reef:tuning: like sparse, yet another place with other
/// parameters, for choosing hyper-parameters and nothing else (environment 3).
/// @throws std::invalid_argument naming the three for any other name.
ReefStyle reefStyle(const std::string& name);

}  // namespace shoal::world
