// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/pair_constraints.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <stdexcept>
#include <string>

#include "shoal/demand.h"

namespace shoal::matching {
namespace {

size_t index(int i) { return static_cast<size_t>(i); }

void checkPair(const std::pair<int, int>& pair, int n) {
  const auto& [i, j] = pair;
  if (i >= 0 && j >= 0 && i < n && j < n) return;
  throw std::invalid_argument("labels " + std::to_string(i) + " and " + std::to_string(j) +
                              " are constrained; both in [0, " + std::to_string(n) + ") would be right");
}

}  // namespace

Contraction contract(int n, const PairConstraints& constraints) {
  std::vector<int> root(index(n));  // of a forest whose roots are lowest
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int v) {
    while (root[index(v)] != v) v = root[index(v)] = root[index(root[index(v)])];
    return v;
  };
  for (const auto& pair : constraints.together) {
    checkPair(pair, n);
    const auto [low, high] = std::minmax({find(pair.first), find(pair.second)});
    root[index(high)] = low;
  }
  Contraction result;
  for (int v = 0; v < n; ++v) {
    const int first = find(v);
    const int group = first == v ? result.numGroups() : result.group[index(first)];
    if (first == v) result.members.emplace_back();
    result.members[index(group)].push_back(v);
    result.group.push_back(group);
  }
  for (const auto& pair : constraints.apart) {
    checkPair(pair, n);
    const auto [g, h] = std::minmax({result.group[index(pair.first)], result.group[index(pair.second)]});
    if (g == h) {
      throw std::invalid_argument("labels " + std::to_string(pair.first) + " and " +
                                  std::to_string(pair.second) + " are to be both together and apart");
    }
    result.apart.emplace_back(g, h);
  }
  std::ranges::sort(result.apart);
  result.apart.erase(std::unique(result.apart.begin(), result.apart.end()), result.apart.end());
  return result;
}

PairConstraints restrict(const Contraction& contraction, const Conflicts& conflicts,
                         std::span<const int> place) {
  SHOAL_DEMAND(place.size() == contraction.group.size());
  PairConstraints kept;
  std::vector<int> first(contraction.members.size(), -1);  // per group, the place of its first vertex kept
  for (size_t v = 0; v < place.size(); ++v) {
    if (place[v] < 0) continue;
    int& known = first[index(contraction.group[v])];
    if (known < 0) {
      known = place[v];
    } else {
      kept.together.emplace_back(known, place[v]);
    }
  }
  for (int g = 0; g < contraction.numGroups(); ++g) {
    for (const int h : conflicts.of(g)) {
      if (g < h && first[index(g)] >= 0 && first[index(h)] >= 0)
        kept.apart.emplace_back(first[index(g)], first[index(h)]);
    }
  }
  return kept;
}

Clustering extend(const Contraction& contraction, std::span<const int> place, const Clustering& matched) {
  SHOAL_DEMAND(place.size() == contraction.group.size());
  std::vector<int> of_group(contraction.members.size(), -1);
  for (size_t v = 0; v < place.size(); ++v)
    if (place[v] >= 0) of_group[index(contraction.group[v])] = matched.label.at(index(place[v]));
  int universe = matched.universe;
  std::vector<int> label;
  for (size_t v = 0; v < place.size(); ++v) {
    int& own = of_group[index(contraction.group[v])];
    if (own < 0) own = universe++;
    label.push_back(place[v] >= 0 ? matched.label[index(place[v])] : own);
  }
  return numberByFirstAppearance(label, universe);
}

Clustering repair(const Contraction& contraction, const Clustering& clustering, std::span<const int> owner) {
  SHOAL_DEMAND(clustering.label.size() == contraction.group.size());
  const Conflicts conflicts(contraction, owner);
  std::map<int, std::vector<int>> holders;  // of each label, groups
  std::vector<int> of_group;
  int universe = clustering.universe;
  for (int g = 0; g < contraction.numGroups(); ++g) {
    int label = clustering.label[index(contraction.members[index(g)].front())];
    const auto& others = holders[label];
    if (std::ranges::any_of(others, [&](int other) { return conflicts.between(g, other); }))
      label = universe++;
    holders[label].push_back(g);
    of_group.push_back(label);
  }
  std::vector<int> label;
  for (const int g : contraction.group) label.push_back(of_group[index(g)]);
  return numberByFirstAppearance(label, universe);
}

Conflicts::Conflicts(const Contraction& contraction, std::span<const int> owner)
    : of_(contraction.members.size()) {
  for (const auto& [g, h] : contraction.apart) {
    of_[index(g)].push_back(h);
    of_[index(h)].push_back(g);
  }
  std::map<int, std::vector<int>> groups_of;
  for (size_t v = 0; v < owner.size(); ++v) groups_of[owner[v]].push_back(contraction.group[v]);
  for (const auto& [robot, groups] : groups_of) {
    for (const int g : groups)
      for (const int h : groups)
        if (g != h) of_[index(g)].push_back(h);
  }
  for (std::vector<int>& others : of_) {
    std::ranges::sort(others);
    others.erase(std::unique(others.begin(), others.end()), others.end());
  }
}

bool Conflicts::between(int group, int other) const { return std::ranges::binary_search(of(group), other); }

}  // namespace shoal::matching
