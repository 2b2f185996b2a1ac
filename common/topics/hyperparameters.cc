// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/hyperparameters.h"

#include "shoal/topics/range.h"

namespace shoal::topics {

void check(const Hyperparameters& h) {
  checkRange("max_topics", h.max_topics, 1, 10000);
  checkRange("alpha", h.alpha, 1e-9, 1e6);
  checkRange("beta", h.beta, 1e-9, 1e6);
  if (h.gamma != 0.0) checkRange("gamma, unless 0,", h.gamma, 1e-30, 1e6);
  checkRange("neighbor_weight", h.neighbor_weight, 0.0, 1.0);
  checkRange("tau", h.tau, 1e-3, 1e3);
  checkRange("local_rate", h.local_rate, 0.0, 1.0);
  checkRange("resamples_per_observation", h.resamples_per_observation, int64_t{0}, int64_t{1} << 40);
}

}  // namespace shoal::topics
