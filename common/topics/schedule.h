// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "shoal/random.h"

namespace shoal::topics {

/// The point x in [0, 1] below which Beta(1, tau) has the share `u` in [0, 1): 1 - (1 - u)^(1/tau).
///
/// tau < 1 piles up at 1 (tau = .5: mean 2/3), tau = 1 is uniform. Where 1/tau is 1 or 2 no library
/// function is used; std::pow elsewhere, whose last bit may differ between C libraries.
double betaQuantile(double u, double tau);

/// How visits are shared out between the newest image and the past.
struct VisitLaw {
  double tau = 0.5;         ///< recency of the past, as betaQuantile()
  double local_rate = 0.5;  ///< share of the visits that go to the latest observation, in [0, 1]
};

/// Number of the cell to visit next.
///
/// With probability local_rate one of `latest`, each alike; else cell floor(x C), x ~ Beta(1, tau), over all
/// C cells in order of creation, the newest most often. Without `latest` every visit is of the second kind.
///
/// @param latest     Cells of the latest observation, numbers below num_cells.
/// @param num_cells  C, > 0.
/// Source: refinement weights of Sunshine (p_refine_rate_local, p_refine_rate_global, tau).
int32_t nextVisit(const VisitLaw& law, std::span<const int32_t> latest, int32_t num_cells, Random& random);

}  // namespace shoal::topics
