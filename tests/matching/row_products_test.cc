// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/row_products.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "shoal/random.h"

namespace shoal::matching {
namespace {

// 2^20 everywhere is the most there may be: 4096 products fill 52 bits, and there are more of them.
TEST(WholeRowsTest, MultiplyExactly) {
  for (const size_t width : {1u, 5u, 1200u, 4096u, 9001u}) {
    SCOPED_TRACE(width);
    constexpr size_t kRows = 7;
    constexpr int64_t kMost = int64_t{1} << 20;
    Random random(width);
    WholeRows rows(kRows, width);
    std::vector<std::vector<int64_t>> plain(8, std::vector<int64_t>(width));
    for (size_t i = 0; i < kRows; ++i) {
      for (size_t k = 0; k < width; ++k) {
        plain[i][k] = i < 2 ? kMost : static_cast<int64_t>(random.below(2 * kMost + 1)) - kMost;
        rows.row(i)[k] = static_cast<double>(plain[i][k]);
      }
    }
    ASSERT_EQ(rows.numBlocks(), 2u);
    for (size_t a = 0; a < 8; ++a) {
      for (size_t b = 0; b < 8; ++b) {
        int64_t expected = 0;
        for (size_t k = 0; k < width; ++k) expected += plain[a][k] * plain[b][k];
        ASSERT_EQ(rows.products(a / 4, b / 4)[a % 4][b % 4], expected) << a << ", " << b;
      }
    }
  }
}

}  // namespace
}  // namespace shoal::matching
