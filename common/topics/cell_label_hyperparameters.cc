// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/cell_label_hyperparameters.h"

#include "shoal/topics/range.h"

namespace shoal::topics {

void check(const CellLabelHyperparameters& h) {
  checkRange("max_topics", h.max_topics, 1, 10000);
  checkRange("cells_per_topic", h.cells_per_topic, 1, 1'000'000);
  checkRange("evidence", h.evidence, 1e-3, 1e6);
  checkRange("beta", h.beta, 1.0 / 256, 1e4);
  checkRange("coupling", h.coupling, 0.0, 100.0);
  checkRange("tau", h.tau, 1e-3, 1e3);
  checkRange("local_rate", h.local_rate, 0.0, 1.0);
  checkRange("twin_similarity", h.twin_similarity, 1e-3, 1.0);
  checkRange("visits_per_cell", h.visits_per_cell, 0.0, 1e6);
}

}  // namespace shoal::topics
