// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "shoal/matching/association_graph.h"
#include "shoal/matching/clustering.h"
#include "shoal/matching/descriptors.h"
#include "shoal/matching/similarity.h"

namespace shoal::matching {

/// What decides a match. All of it changes the answer.
struct MatcherOptions {
  std::string matcher = "clear";      ///< one of matcherNames()
  std::string similarity = "cosine";  ///< one of similarityNames()
  double sigma = 0.75;                ///< "clear": pairs at least this similar are edges; in [1e-9, 1]
  bool distinct = true;               ///< labels of one robot stay apart; false is for "clear" alone
};

/// @throws std::invalid_argument naming the option that is wrong or not built, and what would be right.
void check(const MatcherOptions& options);

/// Matchers that are built: "id", "hungarian", "clear".
const std::vector<std::string>& matcherNames();

/// The similarity that goes with a matcher in the paper's figures: "l2" with "hungarian", else "cosine".
std::string usualSimilarity(std::string_view matcher);

/// Joins topics of several robots under common labels.
///
/// Pure: equal input, equal output. The caller orders robots and topics canonically. Topics without words are
/// joined with nothing by "hungarian" and "clear" and change nothing for the others.
/// @throws std::invalid_argument naming the option or the descriptor that is wrong, and what would be right.
Clustering match(const DescriptorSet& topics, const MatcherOptions& options);

/// The same on an association graph whose edges are given. Only matchers that look at nothing else ("clear")
/// can do this; others are refused by name.
Clustering match(const AssociationGraph& graph, const MatcherOptions& options);

}  // namespace shoal::matching
