// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "shoal/matching/clustering.h"
#include "shoal/matching/descriptors.h"
#include "shoal/matching/similarity.h"

namespace shoal::matching {

/// The fair baseline: every robot against what all before it have found.
///
/// A global label is the running mean of its topics' descriptors, each divided by its sum, so that a topic
/// counts once however much was seen of it. Robot after robot, topics are assigned to distinct labels so that
/// the sum of similarity - sigma is greatest; what reaches `sigma` with no label that is left for it opens a
/// label of its own, which the robots after it can join. Two topics of one robot never share a label.
///
/// The means are exact: shares are whole multiples of 2^-40 and are summed as integers.
///
/// @param topics  valid: check(topics) has passed. The robots' order is the caller's, and matters.
/// @param sigma   in [0, 1].
///
/// Cost: a robot of k topics against m labels takes k·m similarities and O(k² (m + k)).
Clustering matchIncrementally(const DescriptorSet& topics, Similarity similarity, double sigma);

}  // namespace shoal::matching
