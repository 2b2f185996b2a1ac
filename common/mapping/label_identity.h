// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "shoal/mapping/stacked_topics.h"
#include "shoal/matching/clustering.h"

namespace shoal::mapping {

/// The global label of every stacked topic: the number of the oldest topic in its cluster (creation time,
/// then robot, then id), so that a label lives as long as its oldest topic.
/// @param clustering  of stacked.topics, from matchTopics().
std::vector<world::GlobalLabel> stableLabels(const StackedTopics& stacked,
                                             const matching::Clustering& clustering);

}  // namespace shoal::mapping
