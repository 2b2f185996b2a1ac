// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "shoal/mapping/stacked_topics.h"
#include "shoal/matching/matcher.h"

namespace shoal::mapping {

/// How alike two different vertices of `stacked.descriptors` are in the eyes of a matcher, in [-1, 1].
/// `stacked` outlives it.
using VertexSimilarity = std::function<double(int, int)>;

/// @throws std::invalid_argument for a similarity that does not exist.
VertexSimilarity similarityOf(const StackedTopics& stacked, const matching::MatcherOptions& options);

}  // namespace shoal::mapping
