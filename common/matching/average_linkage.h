// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "shoal/matching/discounted_similarity.h"
#include "shoal/matching/pair_constraints.h"

namespace shoal::matching {

/// Average linkage: every vertex begins alone, and the two clusters of greatest mean similarity between their
/// members are joined again and again while that mean is at least `sigma`.
///
/// Means are compared exactly, as fractions. Of equal ones the pair goes first whose clusters hold the vertex
/// of lowest `rank`, then the next lowest.
/// @param sigma_nano  in units of 1e-9.
/// @param rank  a permutation of 0 .. n - 1, that decides ties.
/// @returns per vertex the number of its cluster, arbitrary.
/// @throws std::invalid_argument naming a pair that must be both together and apart.
/// Cost: O(n²) memory; O(n²) time for usual input, O(n³) at worst.
std::vector<int> averageLinkage(const PairTable& similarity, int64_t sigma_nano, std::span<const int> rank,
                                const PairConstraints& constraints = {});

}  // namespace shoal::matching
