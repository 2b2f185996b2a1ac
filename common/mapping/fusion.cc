// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/fusion.h"

#include "shoal/mapping/fused_map.h"

namespace shoal::mapping {

GlobalMap fuse(const BeliefStore& beliefs, const matching::MatcherOptions& options) {
  FusedMap fused;
  fused.update(beliefs, options);
  return fused.map();
}

}  // namespace shoal::mapping
