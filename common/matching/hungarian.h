// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "shoal/matching/clustering.h"
#include "shoal/matching/descriptors.h"
#include "shoal/matching/similarity.h"

namespace shoal::matching {

/// The paper's baseline: every robot against the first, one after the other.
///
/// The first robot that has topics is the reference. Each further robot's topics are assigned to the
/// reference's so that the sum of 1 - similarity is least, without rejection: a pair is matched however
/// unlike it is. Topics left over, when a robot has more than the reference, get labels of their own, which
/// are not added to the reference: what robots 2 and 3 both found new is never joined. The paper's figures
/// use l2().
///
/// @param topics  valid: check(topics) has passed. An empty topic is matched like any other.
///
/// Cost: k² similarities and O(k³) per robot. Source: Jamieson et al. 2021, §V; the robots' order is the
/// caller's.
Clustering matchSequentially(const DescriptorSet& topics, Similarity similarity);

}  // namespace shoal::matching
