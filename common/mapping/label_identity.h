// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "shoal/mapping/stacked_topics.h"
#include "shoal/matching/clustering.h"

namespace shoal::mapping {

/// The global label of every stacked topic: the number of the oldest topic in its cluster (creation time,
/// then robot, then id), so that a label lives as long as its oldest topic. A topic outside the matching is a
/// cluster of its own.
std::vector<world::GlobalLabel> stableLabels(const StackedTopics& stacked,
                                             const matching::Clustering& clustering);

}  // namespace shoal::mapping
