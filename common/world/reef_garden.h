// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shoal/world/reef_fields.h"
#include "shoal/world/reef_forms.h"
#include "shoal/world/reef_style.h"

namespace shoal::world {

/// All that stands on the ground of a reef: where, how large, which specimen. Immutable.
class ReefGarden {
 public:
  struct Thing {
    float x, y, z;       ///< metres, world (y to the north); z of the ground it stands on
    float cosine, sine;  ///< of the turn about the vertical
    float radius;        ///< metres
    float mix;           ///< to which of its class's colours it tends, about [-1, 1]
    uint16_t specimen;
    uint8_t label;
  };
  static constexpr float kReach = 4.0f;    ///< metres from a thing's middle beyond which nothing of it is
  static constexpr float kTallest = 4.8f;  ///< metres over the ground

  ReefGarden(const ReefStyle& style, const ReefFields& fields);

  /// The things whose middles lie in a strip of bins of 2 m: bins first <= x <= last of row y (southwards),
  /// both within [0, kBins).
  std::span<const Thing> strip(int first, int last, int y) const {
    const auto at = [&](int x) { return static_cast<size_t>(y * kBins + x); };
    return {things_.data() + first_in_bin_[at(first)], things_.data() + first_in_bin_[at(last) + 1]};
  }
  static constexpr float kBinSide = 2.0f;
  static constexpr int kBins = static_cast<int>(ReefFields::kSide / kBinSide);
  /// Of a coordinate, metres from the north-west corner; beyond the square, the outermost.
  static int binOf(float p);

  const std::vector<Part>& parts(const Thing& thing) const { return specimens_[thing.specimen]; }

  /// A part where the thing stands.
  static Ellipsoid placed(const Ellipsoid& solid, const Thing& thing);

 private:
  void plant(const ReefStyle& style, const ReefFields& fields);
  void sortIntoBins();

  std::vector<std::vector<Part>> specimens_;
  std::vector<Thing> things_;          // bin after bin
  std::vector<int32_t> first_in_bin_;  // into things_; one more than there are bins
};

}  // namespace shoal::world
