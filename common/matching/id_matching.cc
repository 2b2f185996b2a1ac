// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/id_matching.h"

#include <set>
#include <stdexcept>
#include <string>

namespace shoal::matching {

Clustering matchById(const DescriptorSet& topics) {
  std::vector<int> slots;
  std::set<int> all;
  for (size_t r = 0; r < topics.robots.size(); ++r) {
    std::set<int> own;
    for (const Descriptor& topic : topics.robots[r]) {
      if (!own.insert(topic.slot).second) {
        throw std::invalid_argument("robot " + std::to_string(r) + " has slot " + std::to_string(topic.slot) +
                                    " twice, once would be right");
      }
      slots.push_back(topic.slot);
    }
    all.merge(own);
  }
  return numberByFirstAppearance(slots, static_cast<int>(all.size()));
}

}  // namespace shoal::matching
