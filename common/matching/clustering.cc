// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/clustering.h"

#include <map>

#include "shoal/demand.h"

namespace shoal::matching {

Clustering numberByFirstAppearance(std::span<const int> label, int universe) {
  Clustering clustering;
  std::map<int, int> number;
  clustering.label.reserve(label.size());
  for (const int l : label) {
    clustering.label.push_back(number.try_emplace(l, static_cast<int>(number.size())).first->second);
  }
  clustering.num_labels = static_cast<int>(number.size());
  clustering.universe = universe;
  SHOAL_DEMAND(universe >= clustering.num_labels);
  return clustering;
}

}  // namespace shoal::matching
