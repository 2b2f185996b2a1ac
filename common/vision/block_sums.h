// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace shoal::vision {

/// Edge of a block, pixels. Dense words have one point a block: its middle.
inline constexpr int kBlockSize = 8;

/// N sums over the pixels of each 8 x 8 block of an image. A window of 24 x 24 pixels around the middle of a
/// block is the block and the eight around it, so windows cost nine additions, exactly.
template <size_t N>
class BlockSums {
 public:
  using Sums = std::array<int64_t, N>;

  struct Window {
    Sums sums{};
    int64_t num_blocks = 0;  ///< in [1, 9]: what lies outside the image is left out
  };

  BlockSums(int columns, int rows)
      : columns_(columns), rows_(rows), sums_(static_cast<size_t>(columns) * static_cast<size_t>(rows)) {}

  int columns() const { return columns_; }
  int rows() const { return rows_; }

  Sums& at(int i, int j) { return sums_[static_cast<size_t>(j * columns_ + i)]; }
  const Sums& at(int i, int j) const { return sums_[static_cast<size_t>(j * columns_ + i)]; }

  /// The sums over block (i, j), column and row, and its neighbours.
  Window window(int i, int j) const {
    Window window;
    for (int y = std::max(j - 1, 0); y <= std::min(j + 1, rows_ - 1); ++y) {
      for (int x = std::max(i - 1, 0); x <= std::min(i + 1, columns_ - 1); ++x) {
        const Sums& sums = at(x, y);
        for (size_t n = 0; n < N; ++n) window.sums[n] += sums[n];
        ++window.num_blocks;
      }
    }
    return window;
  }

 private:
  int columns_, rows_;
  std::vector<Sums> sums_;
};

}  // namespace shoal::vision
