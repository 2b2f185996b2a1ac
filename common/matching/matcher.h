// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shoal/matching/association_graph.h"
#include "shoal/matching/clustering.h"
#include "shoal/matching/descriptors.h"
#include "shoal/matching/match_memory.h"
#include "shoal/matching/pair_constraints.h"
#include "shoal/matching/similarity.h"

namespace shoal::matching {

/// Whether a matcher may give two topics of one robot one label, unless told: "components" and "shoal" do.
bool mergesOwn(std::string_view matcher);

/// What decides a match. All of it changes the answer.
struct MatcherOptions {
  std::string matcher = "clear";  ///< one of matcherNames()
  std::string similarity =
      "cosine";  ///< one of similarityNames(), or "discounted": "clear", "components", "shoal"
  std::optional<double> sigma = {};   ///< least similarity of a match, in [1e-9, 1]; none: usualSigma()
  std::optional<bool> distinct = {};  ///< labels of one robot stay apart; none: mergesOwn()

  bool operator==(const MatcherOptions&) const = default;
  double leastSimilarity() const;
  bool keepsOwnApart() const { return distinct.value_or(!mergesOwn(matcher)); }
};

/// @throws std::invalid_argument naming the option that is wrong, and what would be right.
void check(const MatcherOptions& options);

/// Matchers that are built: "id", "hungarian", "incremental", "components", "clear", "shoal".
const std::vector<std::string>& matcherNames();

/// Whether a matcher decides by sigma: all but "id" and "hungarian" do.
bool usesSigma(std::string_view matcher);

/// The similarity that goes with a matcher: "l2" with "hungarian" and "cosine" else, as in the paper's
/// figures; "discounted" (discounted_similarity.h) with "shoal".
std::string usualSimilarity(std::string_view matcher);

/// What processes match with unless told: "shoal", which was measured best (docs/matching.md).
MatcherOptions usualMatcher();

/// What "auto" stands for: .25 with "shoal" (measured, docs/matching.md), the paper's .75 else.
double usualSigma(std::string_view matcher);

/// Reads "auto" (none) or a number in (0, 1].
/// @throws std::invalid_argument naming another text, and what would be right.
std::optional<double> parseSigma(const std::string& text);

/// Joins topics of several robots under common labels.
///
/// Pure: equal input, equal output. The caller orders robots and topics canonically. Topics without words are
/// joined with nothing by all but "id" and change nothing for the others.
/// Constraints, the operator's links and exclusions, are honoured exactly by every matcher, also for topics
/// without words; what is linked shares a label even if it is one robot's own and these are to stay apart.
/// "clear" and "shoal" match under them (constrained_clear.h, average_linkage.h), "components" takes links
/// for edges; "id", "hungarian" and "incremental" know nothing of them, and what they say is repaired
/// (pair_constraints.h).
///
/// @param memory  when not null: what the last matching found is not worked out again, and this one's is
/// kept. Changes no answer. "clear" and "components" on a similarity of two topics gain by it; the discounted
/// one depends on all topics and is made anew.
/// @throws std::invalid_argument naming the option, the descriptor or the constraint that is wrong, and what
/// would be right.
Clustering match(const DescriptorSet& topics, const MatcherOptions& options,
                 const PairConstraints& constraints = {}, MatchMemory* memory = nullptr);

/// The same on an association graph whose edges are given. Only matchers that look at nothing else
/// ("clear", "components") can do this; others are refused by name.
Clustering match(const AssociationGraph& graph, const MatcherOptions& options,
                 const PairConstraints& constraints = {});

}  // namespace shoal::matching
