// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace shoal::wire {

/// A flat map of labels in patches, `side` x `side`, row by row: uniform noise, relaxed by a Potts model
/// without temperature (cells in random order take a label that most of their eight neighbours have), then a
/// share `speckle` of the cells relabelled at random. Labels lie in [0, num_labels).
std::vector<int> labelField(int side, int num_labels, double speckle);

}  // namespace shoal::wire
