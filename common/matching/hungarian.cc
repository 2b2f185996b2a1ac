// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/hungarian.h"

#include <Eigen/Core>
#include <cmath>
#include <optional>

#include "shoal/matching/assignment.h"

namespace shoal::matching {
namespace {

// Per topic of `robot` the topic of `reference` it is assigned to, if any.
std::vector<std::optional<int>> against(const std::vector<Descriptor>& reference,
                                        const std::vector<Descriptor>& robot, Similarity similarity) {
  Eigen::MatrixXd cost(static_cast<Eigen::Index>(robot.size()), static_cast<Eigen::Index>(reference.size()));
  for (size_t i = 0; i < robot.size(); ++i) {
    for (size_t j = 0; j < reference.size(); ++j) {
      // In whole units of 1e-9, so that sums are exact.
      cost(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          std::nearbyint((1.0 - similarity(robot[i], reference[j])) * 1e9);
    }
  }
  std::vector<std::optional<int>> match(robot.size());
  if (robot.size() <= reference.size()) {
    const std::vector<int> column = assign(cost);
    for (size_t i = 0; i < robot.size(); ++i) match[i] = column[i];
  } else {
    const std::vector<int> row = assign(cost.transpose());
    for (size_t j = 0; j < row.size(); ++j) match[static_cast<size_t>(row[j])] = static_cast<int>(j);
  }
  return match;
}

}  // namespace

Clustering matchSequentially(const DescriptorSet& topics, Similarity similarity) {
  const std::vector<Descriptor>* reference = nullptr;
  std::vector<int> label;
  int num_labels = 0;
  for (const std::vector<Descriptor>& robot : topics.robots) {
    if (robot.empty()) continue;
    if (reference == nullptr) {
      reference = &robot;
      while (num_labels < static_cast<int>(robot.size())) label.push_back(num_labels++);
      continue;
    }
    for (const std::optional<int> match : against(*reference, robot, similarity)) {
      label.push_back(match ? *match : num_labels++);
    }
  }
  return numberByFirstAppearance(label, num_labels);
}

}  // namespace shoal::matching
