// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/likeliest_labels.h"

#include <algorithm>
#include <utility>

#include "shoal/demand.h"

namespace shoal::topics {

std::vector<int32_t> likeliestLabels(const LabelLikelihoods& likelihoods, const Neighborhood& neighborhood,
                                     const ConditionalScale& scale, int rounds) {
  const int32_t num_cells = neighborhood.size();
  SHOAL_DEMAND(std::ssize(likelihoods.num_words) == num_cells);
  std::vector<int32_t> votes(static_cast<size_t>(likelihoods.num_labels));
  std::vector<int32_t> label(static_cast<size_t>(num_cells));
  const auto likeliest = [&](int32_t c) {
    return likeliestLabel(likelihoods.of(c), likelihoods.num_words[static_cast<size_t>(c)], votes, scale);
  };
  for (int32_t c = 0; c < num_cells; ++c) label[static_cast<size_t>(c)] = likeliest(c);
  bool changes = true;
  for (int round = 0; round < rounds && changes; ++round) {
    changes = false;
    for (int32_t c = 0; c < num_cells; ++c) {
      std::ranges::fill(votes, 0);
      for (const int32_t neighbor : neighborhood.of(c))
        ++votes[static_cast<size_t>(label[static_cast<size_t>(neighbor)])];
      const int32_t now = likeliest(c);
      changes |= now != std::exchange(label[static_cast<size_t>(c)], now);
    }
  }
  return label;
}

}  // namespace shoal::topics
