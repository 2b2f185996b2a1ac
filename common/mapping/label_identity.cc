// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/label_identity.h"

#include <tuple>

#include "shoal/demand.h"

namespace shoal::mapping {

std::vector<world::GlobalLabel> stableLabels(const StackedTopics& stacked,
                                             const matching::Clustering& clustering) {
  SHOAL_DEMAND(clustering.label.size() == stacked.topics.size());
  std::vector<const HeardTopic*> oldest(static_cast<size_t>(clustering.num_labels), nullptr);
  const auto age = [](const HeardTopic& t) { return std::tuple(t.created, t.robot, t.id); };
  for (size_t i = 0; i < stacked.topics.size(); ++i) {
    const HeardTopic*& first = oldest.at(static_cast<size_t>(clustering.label[i]));
    if (first == nullptr || age(stacked.topics[i]) < age(*first)) first = &stacked.topics[i];
  }
  std::vector<world::GlobalLabel> labels;
  for (const int cluster : clustering.label) {
    const HeardTopic* namesake = oldest[static_cast<size_t>(cluster)];
    labels.push_back(world::globalLabel(namesake->robot, namesake->id));
  }
  return labels;
}

}  // namespace shoal::mapping
