// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/surprise.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "shoal/demand.h"
#include "shoal/topics/fixed_log.h"

namespace shoal::topics {

double bitsPerWord(std::span<const int64_t> log_likelihoods, std::span<const int32_t> cells_of_label,
                   int64_t num_words) {
  SHOAL_DEMAND(cells_of_label.size() == log_likelihoods.size() && num_words > 0);
  int64_t largest = std::numeric_limits<int64_t>::min();
  for (size_t k = 0; k < cells_of_label.size(); ++k) {
    if (cells_of_label[k] > 0) largest = std::max(largest, log_likelihoods[k]);
  }
  uint64_t sum = 0;  // of the shares, relative to the largest likelihood: below 2^63
  for (size_t k = 0; k < cells_of_label.size(); ++k) {
    if (cells_of_label[k] == 0) continue;
    sum += static_cast<uint64_t>(cells_of_label[k]) * fixedExp2(largest - log_likelihoods[k]);
  }
  const auto cells = std::accumulate(cells_of_label.begin(), cells_of_label.end(), uint64_t{0});
  const int64_t log_share = int64_t{fixedLog2(sum)} - 32 * kLogOne - int64_t{fixedLog2(cells)};
  return -static_cast<double>(largest + log_share) / static_cast<double>(kLogOne * num_words);
}

}  // namespace shoal::topics
