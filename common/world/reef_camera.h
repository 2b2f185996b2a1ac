// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "shoal/world/reef_style.h"

namespace shoal::world {

/// What water leaves of a colour, and what it adds, at a range: J e^(-a r) + V (1 - e^(-b r)).
/// Source: Akkaynak and Treibitz, "A Revised Underwater Image Formation Model", CVPR 2018; coefficients about
/// those of clear coastal water.
class WaterColumn {
 public:
  explicit WaterColumn(const Water& water);

  /// What of `color` is seen from range_m >= 0.
  Color seen(const Color& color, float range_m) const {
    const Effect& e =
        table_[static_cast<size_t>(std::min(range_m * kPerMetre, static_cast<float>(table_.size() - 1)))];
    return {color[0] * e.kept[0] + e.added[0], color[1] * e.kept[1] + e.added[1],
            color[2] * e.kept[2] + e.added[2]};
  }

 private:
  struct Effect {
    Color kept, added;
  };
  static constexpr float kPerMetre = 16.0f;
  std::array<Effect, 1024> table_;  // to 64 m, beyond which the water is all there is to see
};

/// The light that falls on a sensor, pixel by pixel, row by row, and the picture it makes of it.
class Film {
 public:
  Film(int width, int height)
      : width_(width),
        height_(height),
        light_(static_cast<size_t>(width) * static_cast<size_t>(height), Color{}) {}

  Color& at(int row, int column) {
    return light_[static_cast<size_t>(row) * static_cast<size_t>(width_) + static_cast<size_t>(column)];
  }

  /// Makes up for a part of what the picture is brighter or darker than usual, as an automatic exposure does.
  void expose();

  /// Scatters each pixel's light over its neighbours, as lens and water do.
  void soften();

  /// The picture: CV_8UC3, BGR. Noise of some two grey levels, more in the light, by `key`.
  cv::Mat develop(uint64_t key) const;

 private:
  int width_, height_;
  std::vector<Color> light_;
};

}  // namespace shoal::world
