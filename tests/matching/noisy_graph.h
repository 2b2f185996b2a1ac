// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "shoal/matching/association_graph.h"
#include "shoal/random.h"

namespace shoal::matching {

/// A cluster graph that noise has hit, and the classes behind it.
struct NoisyGraph {
  AssociationGraph graph;
  std::vector<int> truth;  ///< class per vertex
};

/// Robots that each see `num_topics` of 1.5 times as many classes, chosen at random. Of the true edges a
/// share `missing` is left out; false ones between topics of different robots are added, `false_per_true` for
/// each true edge there was. With both at .15 the graph is one giant component from a few robots on.
inline NoisyGraph makeNoisyGraph(int num_robots, int num_topics, double missing, double false_per_true,
                                 uint64_t seed) {
  Random random(seed, 0x9a7);
  NoisyGraph noisy;
  const int num_classes = num_topics * 3 / 2;
  for (int robot = 0; robot < num_robots; ++robot) {
    std::vector<int> classes(static_cast<size_t>(num_classes));
    std::iota(classes.begin(), classes.end(), 0);
    for (int k = 0; k < num_topics; ++k) {
      const auto other = static_cast<size_t>(k) + random.below(static_cast<uint64_t>(num_classes - k));
      std::swap(classes[static_cast<size_t>(k)], classes[other]);
      noisy.truth.push_back(classes[static_cast<size_t>(k)]);
    }
    noisy.graph.num_topics.push_back(num_topics);
  }
  const int n = num_robots * num_topics;
  std::vector<std::pair<int, int>> edges;
  int num_true = 0;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < j; ++i) {
      if (noisy.truth[static_cast<size_t>(i)] != noisy.truth[static_cast<size_t>(j)]) continue;
      ++num_true;
      if (random.uniform() >= missing) edges.emplace_back(i, j);
    }
  }
  std::set<std::pair<int, int>> wrong;
  for (int wanted = static_cast<int>(std::lround(false_per_true * num_true)); wanted > 0;) {
    const int a = static_cast<int>(random.below(static_cast<uint64_t>(n)));
    const int b = static_cast<int>(random.below(static_cast<uint64_t>(n)));
    if (a / num_topics == b / num_topics) continue;
    if (noisy.truth[static_cast<size_t>(a)] == noisy.truth[static_cast<size_t>(b)]) continue;
    if (wrong.emplace(std::min(a, b), std::max(a, b)).second) --wanted;
  }
  edges.insert(edges.end(), wrong.begin(), wrong.end());
  std::sort(edges.begin(), edges.end());
  for (const auto& [i, j] : edges) noisy.graph.edges.push_back({i, j});
  return noisy;
}

}  // namespace shoal::matching
