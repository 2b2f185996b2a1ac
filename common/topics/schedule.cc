// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/schedule.h"

#include <algorithm>
#include <cmath>

#include "shoal/demand.h"

namespace shoal::topics {

double betaQuantile(double u, double tau) {
  const double rest = 1.0 - u;
  if (tau == 1.0) return u;
  if (tau == 0.5) return 1.0 - rest * rest;
  return 1.0 - std::pow(rest, 1.0 / tau);
}

int32_t nextVisit(const VisitLaw& law, std::span<const int32_t> latest, int32_t num_cells, Random& random) {
  SHOAL_DEMAND(num_cells > 0);
  const bool local = random.uniform() < law.local_rate;
  if (local && !latest.empty()) return latest[random.below(latest.size())];
  const double x = betaQuantile(random.uniform(), law.tau);
  return std::min(static_cast<int32_t>(x * num_cells), num_cells - 1);  // x may round to 1
}

}  // namespace shoal::topics
