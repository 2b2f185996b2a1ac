// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "shoal/matching/association_graph.h"
#include "shoal/matching/clustering.h"
#include "shoal/matching/descriptors.h"

namespace shoal::matching {

/// What decides a match. All of it changes the answer.
struct MatcherOptions {
  std::string matcher = "clear";      ///< one of matcherNames()
  std::string similarity = "cosine";  ///< one of similarityNames()
  double sigma = 0.75;                ///< pairs at least this similar are edges; in (0, 1]
  bool distinct = true;               ///< labels of one robot stay apart
};

/// Matchers that are built: "id", "hungarian", "clear".
const std::vector<std::string>& matcherNames();

/// Similarities that are built: "cosine", "overlap", "l1", "l2".
const std::vector<std::string>& similarityNames();

/// Joins topics of several robots under common labels.
///
/// Pure: equal input, equal output. The caller orders robots and topics canonically.
/// @throws std::invalid_argument naming the option or the descriptor that is wrong, and what would be right.
Clustering match(const DescriptorSet& topics, const MatcherOptions& options);

/// The same on an association graph whose edges are given. Only matchers that look at nothing else ("clear")
/// can do this; others are refused by name.
Clustering match(const AssociationGraph& graph, const MatcherOptions& options);

}  // namespace shoal::matching
