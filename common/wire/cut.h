// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// For this room's .cc files: cutting lists into messages.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

namespace shoal::wire {

/// Cuts [0, count) into runs that each fit, one after the other as long as bisection finds; an empty list is
/// one empty run. `fits(begin, end)` should hold for a shorter run when it holds for a longer one; where it
/// does not quite, runs get shorter than they could be, but still fit.
///
/// @throws std::invalid_argument when a run of one element, or the empty list, does not fit.
template <typename Fits>
std::vector<std::pair<size_t, size_t>> cutRuns(size_t count, size_t max_run, Fits fits) {
  std::vector<std::pair<size_t, size_t>> runs;
  size_t begin = 0;
  size_t guess = max_run;  // the run before is a good guess; usually the first one is all
  do {
    const size_t most = std::min(count - begin, max_run);
    size_t good = 0;        // fits, once it is not 0
    size_t bad = most + 1;  // does not
    for (size_t length = std::min(guess, most); good < length; length = std::min(2 * length, most)) {
      if (!fits(begin, begin + length)) {
        bad = length;
        break;
      }
      good = length;
    }
    while (bad - good > 1) {
      const size_t middle = good + (bad - good) / 2;
      (fits(begin, begin + middle) ? good : bad) = middle;
    }
    if (good == 0 && (count > 0 || !fits(0, 0))) {
      throw std::invalid_argument("not even one element fits into a message of the size allowed");
    }
    runs.emplace_back(begin, begin + good);
    begin += good;
    guess = good;
  } while (begin < count);
  return runs;
}

/// True for the coordinates of a brick whose cells have 32-bit indices.
constexpr bool isBrick(const std::array<int32_t, 3>& index) {
  return std::all_of(index.begin(), index.end(), [](int32_t i) { return i >= -(1 << 27) && i < (1 << 27); });
}

}  // namespace shoal::wire
