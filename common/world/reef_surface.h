// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shoal/world/reef_fields.h"
#include "shoal/world/reef_style.h"

namespace shoal::world {

/// What lies at a point of the seabed.
struct SeabedPoint {
  uint8_t label = 0;  ///< index of a class
  Color color{};      ///< as lit, without water in between
};

/// A procedural seabed over X in [0, 250], Y in [-250, 0] (metres, world): a height for every point, and what
/// lies there. A pure function of style and seed. Immutable.
///
/// The ground rolls gently about Z = 0; what grows on it are bumps, which never rise more steeply than 40
/// degrees, so that a camera looking down sees each point of the surface at most once.
class ReefSurface {
 public:
  static constexpr float kSide = ReefFields::kSide;              ///< metres
  static constexpr float kMinHeight = -1.0f, kMaxHeight = 3.0f;  ///< bounds of heightAt(), metres

  ReefSurface(ReefStyle style, uint64_t seed);

  const ReefStyle& style() const { return style_; }

  /// Height of the surface, metres; continuous, also beyond the square.
  float heightAt(float x, float y) const;

  /// Class and colour, for points of the square. Cost: some 50 ns.
  SeabedPoint at(float x, float y) const;

 private:
  struct Thing {           // a coral head, a boulder: a round bump with a wandering outline
    float x, y;            // metres, y southwards
    float xx, xy, yx, yy;  // metres -> radii along and across: (xx dx + xy dy, yx dx + yy dy)
    float reach, height;   // metres
    float roughness, mix;
    uint8_t label;

    std::array<float, 2> inRadii(float at_x, float at_y) const {
      const float dx = at_x - x, dy = at_y - y;
      return {xx * dx + xy * dy, yx * dx + yy * dy};
    }
  };
  static constexpr float kReach = 1.5f;  // of a bump, over its radius

  std::span<const Thing> thingsNear(float x, float y) const;
  void plant();
  void sortIntoBins(const std::vector<Thing>& planted);

  ReefStyle style_;
  ReefFields fields_;
  TextureTile edges_;
  std::vector<TextureTile> textures_;  // per class
  std::vector<Thing> things_;          // bin after bin of one square metre, those that reach into it
  std::vector<int32_t> first_in_bin_;  // into things_; one more than there are bins
};

}  // namespace shoal::world
