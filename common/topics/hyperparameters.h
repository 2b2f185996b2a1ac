// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace shoal::topics {

/// BNP-ROST's knobs. All of them change the answer. Symbols as in the paper.
struct Hyperparameters {
  int32_t max_topics = 12;       ///< K, upper bound on topics alive at once, in [1, 10000]
  double alpha = 0.1;            ///< prior of a topic in a cell, in [1e-9, 1e6]. Small: one topic a cell
  double beta = 0.1;             ///< prior of a word in a topic, in [1e-9, 1e6]. Large: few, broad topics
  double gamma = 0.0;            ///< weight of a new topic: 0 = all K open from the start, or [1e-30, 1e6]
  double neighbor_weight = 0.5;  ///< g_sigma in [0, 1]: a neighbouring cell's words count this much
  double tau = 0.5;              ///< recency of global visits: cell at x C, x ~ Beta(1, tau), [1e-3, 1e3]
  double local_rate = 0.5;       ///< share of visits that go to the latest observation's cells, in [0, 1]
  int64_t resamples_per_observation = 60000;  ///< word re-samples after each image: a count, never a clock
};

/// @throws std::invalid_argument naming the first field outside its range, its value and the range.
void check(const Hyperparameters& hyperparameters);

}  // namespace shoal::topics
