// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "shoal/matching/clustering.h"
#include "shoal/matching/descriptors.h"

namespace shoal::matching {

/// Takes topics with the same slot for the same: topic j is topic j. Looks at no words. The weakest baseline
/// of the paper.
///
/// @throws std::invalid_argument if a robot has a slot twice.
Clustering matchById(const DescriptorSet& topics);

}  // namespace shoal::matching
