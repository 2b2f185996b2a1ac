// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/association_graph.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace shoal::matching {
namespace {

std::string text(const Edge& e) { return "edge (" + std::to_string(e.i) + ", " + std::to_string(e.j) + ")"; }

std::vector<const Descriptor*> inOneRow(const DescriptorSet& topics) {
  std::vector<const Descriptor*> all;
  for (const std::vector<Descriptor>& robot : topics.robots)
    for (const Descriptor& topic : robot) all.push_back(&topic);
  return all;
}

AssociationGraph withoutEdges(const DescriptorSet& topics) {
  AssociationGraph graph;
  for (const std::vector<Descriptor>& robot : topics.robots)
    graph.num_topics.push_back(static_cast<int>(robot.size()));
  return graph;
}

}  // namespace

void check(const AssociationGraph& graph) {
  for (size_t r = 0; r < graph.num_topics.size(); ++r) {
    if (graph.num_topics[r] < 0) {
      throw std::invalid_argument("robot " + std::to_string(r) + " cannot have " +
                                  std::to_string(graph.num_topics[r]) + " topics, 0 or more would be right");
    }
  }
  const int n = graph.numVertices();
  const auto ends = [](const Edge& e) { return std::pair{e.i, e.j}; };
  bool ascends = true;
  for (size_t k = 0; k < graph.edges.size(); ++k) {
    const Edge& e = graph.edges[k];
    if (e.i < 0 || e.j >= n || e.i >= e.j) {
      throw std::invalid_argument(text(e) + " is not 0 <= i < j < " + std::to_string(n));
    }
    if (!std::isfinite(e.weight) || e.weight < 0.0) {
      throw std::invalid_argument(text(e) + " has weight " + std::to_string(e.weight) +
                                  ", a finite number >= 0 would be right");
    }
    ascends = ascends && (k == 0 || ends(graph.edges[k - 1]) < ends(e));
  }
  if (ascends) return;  // as our own graphs do: no edge is there twice
  std::vector<std::pair<int, int>> pairs;
  for (const Edge& e : graph.edges) pairs.push_back(ends(e));
  std::sort(pairs.begin(), pairs.end());
  const auto twice = std::adjacent_find(pairs.begin(), pairs.end());
  if (twice != pairs.end()) {
    throw std::invalid_argument(text({twice->first, twice->second}) + " is there twice");
  }
}

std::vector<int> owners(const AssociationGraph& graph) {
  std::vector<int> owner;
  for (size_t r = 0; r < graph.num_topics.size(); ++r) {
    owner.insert(owner.end(), static_cast<size_t>(graph.num_topics[r]), static_cast<int>(r));
  }
  return owner;
}

AssociationGraph associationGraph(const DescriptorSet& topics, Similarity similarity, double sigma,
                                  bool own_pairs, NeighbourMemory* memory) {
  const std::vector<const Descriptor*> all = inOneRow(topics);
  AssociationGraph graph = withoutEdges(topics);
  const std::vector<int> owner = owners(graph);
  for (const auto& [i, j] :
       memory != nullptr ? memory->pairs(all, similarity, sigma) : neighbours(all, similarity, sigma)) {
    if (own_pairs || owner[static_cast<size_t>(i)] != owner[static_cast<size_t>(j)])
      graph.edges.push_back({i, j});
  }
  return graph;
}

AssociationGraph associationGraph(const DescriptorSet& topics, const PairTable& similarity, double sigma,
                                  bool own_pairs) {
  const std::vector<const Descriptor*> all = inOneRow(topics);
  AssociationGraph graph = withoutEdges(topics);
  const std::vector<int> owner = owners(graph);
  const int64_t least = std::llround(sigma * 1e9);
  for (size_t i = 0; i < all.size(); ++i) {
    if (all[i]->entries.empty()) continue;
    for (size_t j = i + 1; j < all.size(); ++j) {
      if (all[j]->entries.empty() || (!own_pairs && owner[i] == owner[j])) continue;
      const auto a = static_cast<int>(i), b = static_cast<int>(j);
      if (similarity.at(a, b) >= least) graph.edges.push_back({a, b});
    }
  }
  return graph;
}

}  // namespace shoal::matching
