// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace shoal::vision {

/// A visual word at a pixel: u columns from the left, v rows from the top.
struct PixelWord {
  int u = 0;
  int v = 0;
  int32_t word = 0;
  bool operator==(const PixelWord&) const = default;
};

}  // namespace shoal::vision
