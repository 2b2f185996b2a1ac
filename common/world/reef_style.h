// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "shoal/world/reef_forms.h"
#include "shoal/world/texture_tile.h"
#include "shoal/world/world.h"

namespace shoal::world {

/// Red, green, blue; 0 to about 1 in full light, before the water takes its part.
using Color = std::array<float, 3>;

/// A class and how it looks: colours from `first` to `second`, by place, specimen and texture.
struct ReefClass {
  TruthClass truth;
  Texture texture = Texture::kSand;
  Color first{}, second{};
  float contrast = 0.3f;  ///< of the brightness of its texture, 0 to 1
  float bump = 1.0f;      ///< of the relief of its texture, as light and shade show it
};

/// Things of one class and form that stand on the ground.
struct Growth {
  uint8_t label = 0;
  Form form = Form::kBoulder;
  float share = 0.0f;  ///< of the ground that its circles cover where it grows, >= 0, before overlaps
  float min_radius_m = 0.4f, max_radius_m = 2.0f;  ///< within [0, 3]; most are small
  int colony = 4;                                  ///< how many stand together
  int ground = kAnyGround;                         ///< index into ReefStyle::ground where alone it grows
  static constexpr int kAnyGround = -1;
};

/// What a part of the reef is like.
struct Terrain {
  std::array<float, 4> ground{};  ///< how much of each of ReefStyle::ground: about [-1, 1], the greatest wins
  Color tint{1.0f, 1.0f, 1.0f};   ///< of the light
  float shade = 0.5f;             ///< part that lies in shadow, [0, 1]
  float swell_m = 0.4f;           ///< height of its hills, 40 m wide
  float rough_m = 0.15f;          ///< height of its humps, 9 m wide
  float ledge_m = 0.0f;           ///< height of its ledges
  std::vector<Growth> growths;
};

/// The water over it.
struct Water {
  Color attenuation{.085f, .030f, .025f};  ///< of what is seen, per metre
  Color backscatter{.040f, .050f, .055f};  ///< of the veil, per metre
  Color veil{.06f, .27f, .37f};            ///< colour of water alone
};

/// Everything that makes one procedural reef differ from another, but for the seed.
struct ReefStyle {
  std::string name;                 ///< "reef:sparse"
  uint64_t salt = 0;                ///< keeps styles apart at equal seeds
  std::vector<ReefClass> classes;   ///< index = label
  std::array<uint8_t, 4> ground{};  ///< labels of what covers the ground: sand first, rock (on slopes) last
  float ground_width_m = 20.0f;     ///< of patches of ground
  Water water;
  std::array<Terrain, 4> terrains;  ///< north-west, north-east, south-west, south-east
};

/// reef:sparse: uniform sand in light and shade, few corals (paper, environment 1). reef:varied: other ground
/// and other species in each quarter (environment 2). reef:tuning: like sparse, yet another place with other
/// parameters, for choosing hyper-parameters and nothing else (environment 3).
/// @throws std::invalid_argument naming the three for any other name.
ReefStyle reefStyle(const std::string& name);

}  // namespace shoal::world
