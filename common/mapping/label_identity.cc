// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/label_identity.h"

#include <tuple>

#include "shoal/demand.h"

namespace shoal::mapping {

std::vector<world::GlobalLabel> stableLabels(const StackedTopics& stacked,
                                             const matching::Clustering& clustering) {
  std::vector<const HeardTopic*> oldest(static_cast<size_t>(clustering.num_labels), nullptr);
  const auto age = [](const HeardTopic& t) { return std::tuple(t.created, t.robot, t.id); };
  const auto clusterOf = [&](size_t topic) {
    return static_cast<size_t>(clustering.label.at(static_cast<size_t>(stacked.vertex[topic])));
  };
  for (size_t i = 0; i < stacked.topics.size(); ++i) {
    if (stacked.vertex[i] < 0) continue;
    const HeardTopic*& first = oldest.at(clusterOf(i));
    if (first == nullptr || age(stacked.topics[i]) < age(*first)) first = &stacked.topics[i];
  }
  std::vector<world::GlobalLabel> labels;
  for (size_t i = 0; i < stacked.topics.size(); ++i) {
    const HeardTopic* namesake = stacked.vertex[i] < 0 ? &stacked.topics[i] : oldest[clusterOf(i)];
    SHOAL_DEMAND(namesake != nullptr);
    labels.push_back(world::globalLabel(namesake->robot, namesake->id));
  }
  return labels;
}

}  // namespace shoal::mapping
