// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/local_belief.h"

#include <cmath>

namespace shoal::mapping {

std::vector<world::WordCount> quantize(const std::vector<world::WordCount>& counts,
                                       const std::vector<world::WordGroup>& groups) {
  std::vector<world::WordCount> quantized;
  auto word = counts.begin();
  for (const world::WordGroup& group : groups) {
    const auto begin = word;
    int64_t squares = 0;
    for (; word != counts.end() && word->word < group.first + group.size; ++word) {
      squares += int64_t{word->count} * word->count;
    }
    // sqrt is correctly rounded by IEEE 754, so every machine gets the same integers.
    const double step = std::sqrt(static_cast<double>(squares)) / 100.0;
    for (auto it = begin; it != word; ++it) {
      const auto level = static_cast<int32_t>(std::floor(it->count / step + 0.5));
      if (level > 0) quantized.push_back({it->word, level});
    }
  }
  return quantized;
}

}  // namespace shoal::mapping
