// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "shoal/matching/descriptors.h"

namespace shoal::matching {

/// How alike two topics are: symmetric, in [0, 1], 1 for a topic and itself, unchanged when one topic's
/// weights are all multiplied. Below, a and b are the weights divided by their sums: no prior is added. Two
/// empty topics are 1 alike, an empty one and another 0.
///
/// A whole multiple of 1e-9, made from exact integer sums: equal on every machine, so that a threshold
/// decides equally. Cost: O(entries).
using Similarity = double (*)(const Descriptor&, const Descriptor&);

/// a·b / (|a| |b|).
double cosine(const Descriptor& a, const Descriptor& b);

/// Σ min(a, b), the "topic overlap" of the paper.
double overlap(const Descriptor& a, const Descriptor& b);

/// 1 - ½ Σ |a - b|, one minus the total variation distance. By identity the same number as overlap(); the two
/// have names of their own because the distance is known by this one.
double l1(const Descriptor& a, const Descriptor& b);

/// 1 - sqrt(½ Σ (a - b)²). One minus this is the cost of the paper's sequential Hungarian.
double l2(const Descriptor& a, const Descriptor& b);

/// 1 - sqrt(½ Σ (√a - √b)²), one minus the Hellinger distance.
double hellinger(const Descriptor& a, const Descriptor& b);

/// 1 - ½ Σ (a log2 (a/m) + b log2 (b/m)) with m = (a + b) / 2, one minus the Jensen-Shannon divergence in
/// bits.
double jensenShannon(const Descriptor& a, const Descriptor& b);

/// Whether two topics of this similarity are joined by an edge: similarity >= sigma in units of 1e-9.
bool reaches(double similarity, double sigma);

/// Similarities that are built: "cosine", "overlap", "l1", "l2", "hellinger", "js".
const std::vector<std::string>& similarityNames();

/// @throws std::invalid_argument for a name that is not among similarityNames(), listing these.
Similarity similarityNamed(std::string_view name);

}  // namespace shoal::matching
