// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace shoal::world {

/// N smooth quantities over a square [0, nodes - 1] x [0, nodes - 1], one node per unit, bilinear between.
template <size_t N>
class CoarseMap {
 public:
  using Values = std::array<float, N>;

  /// `value(x, y)` at every node; nodes >= 2.
  template <class Function>
  CoarseMap(int nodes, Function value) : nodes_(nodes) {
    values_.reserve(static_cast<size_t>(nodes) * static_cast<size_t>(nodes));
    for (int y = 0; y < nodes; ++y) {
      for (int x = 0; x < nodes; ++x) values_.push_back(value(static_cast<float>(x), static_cast<float>(y)));
    }
  }

  /// Outside the square, the nearest border.
  Values at(float x, float y) const {
    const float last = static_cast<float>(nodes_ - 1);
    const float cx = std::clamp(x, 0.0f, last), cy = std::clamp(y, 0.0f, last);
    const int x0 = std::min(static_cast<int>(cx), nodes_ - 2),
              y0 = std::min(static_cast<int>(cy), nodes_ - 2);
    const float fx = cx - static_cast<float>(x0), fy = cy - static_cast<float>(y0);
    const Values* top =
        values_.data() + static_cast<size_t>(y0) * static_cast<size_t>(nodes_) + static_cast<size_t>(x0);
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
  std::vector<Values> values_;  // row by row
};

}  // namespace shoal::world
