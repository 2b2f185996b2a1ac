// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "shoal/mapping/judgement.h"
#include "shoal/mapping/stacked_topics.h"
#include "shoal/matching/matcher.h"

namespace shoal::mapping {

/// Matches the topics under the operators' links and exclusions, which every matcher honours exactly. What
/// two topics must be by way of a third one that is not among them holds; pairs with a robot that is left out
/// do not count.
/// @param judgement  from judge(): links and apart do not contradict one another.
/// @param memory     as matching::match()'s: changes no answer.
/// @returns the label of each of stacked.topics. One outside the matching has a label of its own, or that of
/// the topics it is linked to.
/// @throws std::invalid_argument as matching::match() for wrong options.
matching::Clustering matchTopics(const StackedTopics& stacked, const matching::MatcherOptions& options,
                                 const Judgement& judgement, matching::MatchMemory* memory = nullptr);

}  // namespace shoal::mapping
