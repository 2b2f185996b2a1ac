// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/shoal_matching.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "shoal/matching/discounted_similarity.h"

namespace shoal::matching {
namespace {

// Per vertex its place in an order that depends on content alone, as far as contents differ.
std::vector<int> ranksByContent(const DescriptorSet& topics) {
  std::vector<const Descriptor*> all;
  for (const std::vector<Descriptor>& robot : topics.robots)
    for (const Descriptor& topic : robot) all.push_back(&topic);
  std::vector<int> order(all.size());
  std::iota(order.begin(), order.end(), 0);
  const auto precedes = [](const Descriptor::Entry& a, const Descriptor::Entry& b) {
    return std::pair(a.word, a.weight) < std::pair(b.word, b.weight);
  };
  std::ranges::stable_sort(order, [&](int i, int j) {
    return std::ranges::lexicographical_compare(all[static_cast<size_t>(i)]->entries,
                                                all[static_cast<size_t>(j)]->entries, precedes);
  });
  std::vector<int> rank(all.size());
  for (size_t place = 0; place < order.size(); ++place)
    rank[static_cast<size_t>(order[place])] = static_cast<int>(place);
  return rank;
}

// Of a robot's topics those that nobody wants together.
void keepOwnApart(const DescriptorSet& topics, PairConstraints& constraints) {
  const auto size = [](int n, const std::vector<Descriptor>& robot) {
    return n + static_cast<int>(robot.size());
  };
  const int n = std::accumulate(topics.robots.begin(), topics.robots.end(), 0, size);
  const std::vector<int> group = contract(n, constraints).group;
  int first = 0;
  for (const std::vector<Descriptor>& robot : topics.robots) {
    const int end = first + static_cast<int>(robot.size());
    for (int i = first; i < end; ++i) {
      for (int j = first; j < i; ++j) {
        if (group[static_cast<size_t>(i)] != group[static_cast<size_t>(j)])
          constraints.apart.emplace_back(j, i);
      }
    }
    first = end;
  }
}

}  // namespace

Clustering matchShoal(const DescriptorSet& topics, double sigma, bool distinct,
                      const PairConstraints& constraints) {
  PairConstraints all = constraints;
  if (distinct) keepOwnApart(topics, all);
  const std::vector<int> label =
      averageLinkage(discountedSimilarity(topics), std::llround(sigma * 1e9), ranksByContent(topics), all);
  Clustering clustering = numberByFirstAppearance(label, static_cast<int>(label.size()));
  clustering.universe = clustering.num_labels;
  return clustering;
}

}  // namespace shoal::matching
