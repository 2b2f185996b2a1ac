// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace shoal::matching {

/// Rows of whole numbers as doubles, padded with zeros to whole blocks, so that products of rows go four by
/// four.
class WholeRows {
 public:
  static constexpr size_t kBlock = 4;

  /// All 0. Memory: 8 bytes a number.
  WholeRows(size_t num_rows, size_t width);

  size_t numBlocks() const { return num_blocks_; }
  double* row(size_t i) { return numbers_.data() + i * stride_; }

  /// The dot products of the four rows of block a with the four of block b, exact whatever adds up in what
  /// order: they are summed in doubles over 4096 numbers at a time, which is below 2^53.
  /// Numbers must lie within ±2^20, and the products below 2^63.
  /// Cost: 16 x width multiply-adds, in vectors where the machine has AVX2 and FMA.
  std::array<std::array<int64_t, kBlock>, kBlock> products(size_t a, size_t b) const;

 private:
  size_t num_blocks_, stride_;
  std::vector<double> numbers_;
};

}  // namespace shoal::matching
