// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "shoal/world/reef_fields.h"
#include "shoal/world/reef_garden.h"
#include "shoal/world/reef_style.h"
#include "shoal/world/texture_tile.h"

namespace shoal::world {

/// A procedural reef over X in [0, 250], Y in [-250, 0] (metres, world): ground with relief, and what stands
/// on it. A pure function of style and seed. Immutable. ReefSight looks at it.
class ReefScene {
 public:
  static constexpr float kSide = ReefFields::kSide;  ///< metres
  /// Bounds of everything, metres.
  static constexpr float kLowest = ReefFields::kLowest,
                         kHighest = ReefFields::kHighest + ReefGarden::kTallest;

  ReefScene(ReefStyle style, uint64_t seed);

  const ReefStyle& style() const { return style_; }
  const ReefFields& fields() const { return fields_; }
  const ReefGarden& garden() const { return garden_; }
  const TextureTile& texture(uint8_t label) const { return textures_[label]; }
  const TextureTile& edges() const { return edges_; }
  const TextureTile& caustics() const { return caustics_; }

  /// Height of the bare ground at a point of the square, metres, world: a mesh of squares half a metre wide,
  /// each of two triangles that meet along its diagonal from the south-west to the north-east.
  float groundHeight(float x, float y) const;

 private:
  ReefStyle style_;
  ReefFields fields_;
  ReefGarden garden_;
  TextureTile edges_, caustics_;
  std::vector<TextureTile> textures_;  // per class
};

}  // namespace shoal::world
