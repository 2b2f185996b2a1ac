// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "shoal/matching/average_linkage.h"
#include "shoal/matching/clustering.h"
#include "shoal/matching/descriptors.h"

namespace shoal::matching {

/// The least mean similarity of a match, where nothing else is asked. Measured: docs/matching.md.
inline constexpr double kShoalSigma = 0.25;

/// Joins topics of all robots, and those of one robot among themselves, that look alike in what sets them
/// apart from the place as a whole: average linkage (average_linkage.h) on discountedSimilarity(). No topic
/// is forced on another, and a robot that has cut one phenomenon in two gets it back in one piece.
///
/// Ties go by content, then by canonical order: robots and topics in another order get the same clusters.
///
/// @param topics       valid, and none without words.
/// @param sigma        in [1e-9, 1].
/// @param distinct     labels of one robot stay apart, but for those that `constraints` want together.
/// @param constraints  the operator's; vertices as in Clustering.
/// @throws std::invalid_argument naming a pair that must be both together and apart.
Clustering matchShoal(const DescriptorSet& topics, double sigma, bool distinct,
                      const PairConstraints& constraints = {});

}  // namespace shoal::matching
