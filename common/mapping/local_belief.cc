// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/local_belief.h"

#include <algorithm>
#include <cmath>

namespace shoal::mapping {

std::vector<world::WordCount> quantize(const std::vector<world::WordCount>& counts) {
  double squares = 0;  // of integers, and below 2^53 for any count of words a robot can see: exact
  for (const world::WordCount& w : counts) squares += static_cast<double>(w.count) * w.count;
  // sqrt is correctly rounded by IEEE 754, so every machine gets the same integers.
  const double step = std::max(1.0, std::sqrt(squares) / 1000.0);
  std::vector<world::WordCount> quantized;
  for (const world::WordCount& w : counts) {
    const auto level = static_cast<int32_t>(std::floor(w.count / step + 0.5));
    if (level > 0) quantized.push_back({w.word, level});
  }
  return quantized;
}

}  // namespace shoal::mapping
