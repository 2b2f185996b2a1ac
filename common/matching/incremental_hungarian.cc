// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/incremental_hungarian.h"

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "shoal/matching/assignment.h"

namespace shoal::matching {
namespace {

__extension__ using Wide = __int128;

// The topic's shares of words in whole multiples of 2^-40, rounded to nearest; its sum is about 2^40.
Descriptor normalized(const Descriptor& topic) {
  constexpr int kShareBits = 40;
  Wide total = 0;
  for (const Descriptor::Entry& e : topic.entries) total += e.weight;
  Descriptor shares{topic.slot, {}};
  for (const Descriptor::Entry& e : topic.entries) {
    const Wide share = ((Wide{e.weight} << kShareBits) + total / 2) / total;
    if (share > 0) shares.entries.push_back({e.word, static_cast<int64_t>(share)});
  }
  return shares;
}

// Sums are means: only ratios within a descriptor matter.
void add(Descriptor& sum, const Descriptor& topic) {
  std::map<int32_t, int64_t> weight;
  for (const Descriptor::Entry& e : sum.entries) weight[e.word] += e.weight;
  for (const Descriptor::Entry& e : topic.entries) weight[e.word] += e.weight;
  sum.entries.clear();
  for (const auto& [word, w] : weight) sum.entries.push_back({word, w});
}

// Per topic a label, or a number of at least labels.size() for one that opens its own. In half units of 1e-9,
// so that sums are exact and a similarity equal to sigma still joins.
std::vector<int> assignOrOpen(const std::vector<Descriptor>& robot, const std::vector<Descriptor>& labels,
                              Similarity similarity, double sigma) {
  const auto halves = [](double s) { return 2.0 * std::nearbyint((1.0 - s) * 1e9); };
  const auto num_topics = static_cast<Eigen::Index>(robot.size());
  const auto num_labels = static_cast<Eigen::Index>(labels.size());
  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(num_topics, num_labels + num_topics, halves(sigma) + 1.0);
  for (Eigen::Index i = 0; i < num_topics; ++i) {
    for (Eigen::Index j = 0; j < num_labels; ++j) {
      cost(i, j) = halves(similarity(robot[static_cast<size_t>(i)], labels[static_cast<size_t>(j)]));
    }
  }
  return assign(cost);
}

}  // namespace

Clustering matchIncrementally(const DescriptorSet& topics, Similarity similarity, double sigma) {
  std::vector<Descriptor> labels;
  std::vector<int> label;
  for (const std::vector<Descriptor>& robot : topics.robots) {
    std::vector<Descriptor> shares;
    for (const Descriptor& topic : robot) shares.push_back(normalized(topic));
    const std::vector<int> assigned = assignOrOpen(shares, labels, similarity, sigma);
    const auto known = static_cast<int>(labels.size());
    for (size_t t = 0; t < robot.size(); ++t) {
      if (assigned[t] < known) {
        label.push_back(assigned[t]);
        add(labels[static_cast<size_t>(assigned[t])], shares[t]);
      } else {
        label.push_back(static_cast<int>(labels.size()));
        labels.push_back(shares[t]);
      }
    }
  }
  return numberByFirstAppearance(label, static_cast<int>(labels.size()));
}

}  // namespace shoal::matching
