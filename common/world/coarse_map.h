// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace shoal::world {

/// N smooth quantities over a square from (0, 0), known at nodes `spacing_m` apart, bilinear between.
template <size_t N>
class CoarseMap {
 public:
  using Values = std::array<float, N>;

  /// `value(x, y)` at each of nodes x nodes places; nodes >= 2, x and y in metres.
  template <class Function>
  CoarseMap(int nodes, float spacing_m, Function value) : nodes_(nodes), per_metre_(1.0f / spacing_m) {
    values_.reserve(static_cast<size_t>(nodes) * static_cast<size_t>(nodes));
    for (int y = 0; y < nodes; ++y) {
      for (int x = 0; x < nodes; ++x) {
        values_.push_back(value(static_cast<float>(x) * spacing_m, static_cast<float>(y) * spacing_m));
      }
    }
  }

  /// How many nodes a side has.
  int nodes() const { return nodes_; }

  /// At a node, 0 <= x, y < nodes().
  const Values& node(int x, int y) const {
    return values_[static_cast<size_t>(y) * static_cast<size_t>(nodes_) + static_cast<size_t>(x)];
  }

  /// Outside the square, the nearest border.
  Values at(float x_m, float y_m) const {
    const float last = static_cast<float>(nodes_ - 1);
    const float cx = std::clamp(x_m * per_metre_, 0.0f, last), cy = std::clamp(y_m * per_metre_, 0.0f, last);
    const int x0 = std::min(static_cast<int>(cx), nodes_ - 2),
              y0 = std::min(static_cast<int>(cy), nodes_ - 2);
    const float fx = cx - static_cast<float>(x0), fy = cy - static_cast<float>(y0);
    const Values* top = &node(x0, y0);
    const Values* bottom = top + nodes_;
    const float w00 = (1.0f - fx) * (1.0f - fy), w10 = fx * (1.0f - fy), w01 = (1.0f - fx) * fy,
                w11 = fx * fy;
    Values blended;
    for (size_t i = 0; i < N; ++i) {
      blended[i] = w00 * top[0][i] + w10 * top[1][i] + w01 * bottom[0][i] + w11 * bottom[1][i];
    }
    return blended;
  }

 private:
  int nodes_;
  float per_metre_;             // nodes
  std::vector<Values> values_;  // row by row
};

}  // namespace shoal::world
