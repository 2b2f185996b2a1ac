// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

namespace shoal::matching {

/// What every matcher returns: a label per vertex.
struct Clustering {
  std::vector<int> label;  ///< per vertex, numbered by first appearance from 0
  int num_labels = 0;      ///< labels in use
  int universe = 0;        ///< labels the matcher made room for (CLEAR's m after the floor), >= num_labels
};

/// The clustering that groups the vertices as `label` does, whatever numbers it uses.
Clustering numberByFirstAppearance(std::span<const int> label, int universe);

}  // namespace shoal::matching
