// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace shoal::vision {

/// An image of one 16-bit channel with a border of one pixel, so that loops need no cases at its edge.
class Plane {
 public:
  /// All 0. @param columns, rows  > 0, without the border.
  Plane(int columns, int rows)
      : columns_(columns),
        rows_(rows),
        values_(static_cast<size_t>(columns + 2) * static_cast<size_t>(rows + 2)) {}

  int columns() const { return columns_; }
  int rows() const { return rows_; }

  /// Row v in [-1, rows]; its elements -1 and `columns` are border.
  int16_t* row(int v) { return values_.data() + static_cast<ptrdiff_t>(v + 1) * (columns_ + 2) + 1; }
  const int16_t* row(int v) const {
    return values_.data() + static_cast<ptrdiff_t>(v + 1) * (columns_ + 2) + 1;
  }

  /// Gives the border the values of the nearest pixels inside.
  void fillBorder() {
    for (int v = 0; v < rows_; ++v) {
      row(v)[-1] = row(v)[0];
      row(v)[columns_] = row(v)[columns_ - 1];
    }
    std::copy_n(row(0) - 1, columns_ + 2, row(-1) - 1);
    std::copy_n(row(rows_ - 1) - 1, columns_ + 2, row(rows_) - 1);
  }

 private:
  int columns_, rows_;
  std::vector<int16_t> values_;
};

}  // namespace shoal::vision
