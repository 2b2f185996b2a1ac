// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shoal/topics/label_counts.h"

namespace shoal::topics {

/// Which labels are one thing cut in pieces. A sampler that moves one cell at a time splits what is common
/// more often than it can join it again; many labels find rare things, and twins are told as one afterwards.
///
/// Two labels are as alike as what sets them apart from all of them together: with every group of words a
/// distribution φ of its own (mixed with 100 words of the background b, the mean of all labels, one vote
/// each, and of the uniform distribution with a quarter of one), the cosine of sqrt(φ) - sqrt(b). The two
/// sets of labels of greatest mean similarity are joined, again and again, while that mean is at least
/// `least`.
///
/// @param labels  those in use, ascending.
/// @param least   in (0, 1]; from 1 on nothing is joined.
/// @returns       for each of `labels` the lowest label of its set.
/// Divisions and square roots are IEEE 754's, sums exact or in one order: the same on every machine.
/// Cost: O(K² V + K³) for K labels in use; .4 ms for 16 of 1200 words.
std::vector<int32_t> twinLabels(const LabelCounts& counts, std::span<const int32_t> labels, double least);

}  // namespace shoal::topics
