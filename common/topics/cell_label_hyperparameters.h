// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace shoal::topics {

/// CellLabelModel's knobs. All of them change the answer.
struct CellLabelHyperparameters {
  int32_t max_topics = 32;       ///< K, upper bound on topics alive at once, in [1, 10000]
  int32_t cells_per_topic = 25;  ///< at most this part of the cells seen, but 2, may be topics; in [1, 1e6]
  double evidence = 10.0;        ///< a cell is worth at most so many words, [1e-3, 1e6]. Small: soft labels
  double beta = 0.05;            ///< prior of a word in a topic, in [1/256, 1e4], in steps of 1/256
  double coupling = 1.0;         ///< J, log odds that one alike neighbour adds, in [0, 100]
  double tau = 1.0;              ///< recency of global visits: cell at x C, x ~ Beta(1, tau), [1e-3, 1e3]
  double local_rate = 0.2;       ///< share of visits that go to the latest observation's cells, in [0, 1]
  double twin_similarity =
      0.4;  ///< topics at least so alike are told as one (twin_labels.h), (0, 1]; 1: none
  double visits_per_cell = 8.0;  ///< visits after each image, times its cells, in [0, 1e6]
};

/// @throws std::invalid_argument naming the first field outside its range, its value and the range.
void check(const CellLabelHyperparameters& hyperparameters);

}  // namespace shoal::topics
