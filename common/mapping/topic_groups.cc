// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/topic_groups.h"

namespace shoal::mapping {

bool TopicGroups::add(const Topic& a, const Topic& b, bool apart) {
  size_t first = rootOf(a), second = rootOf(b);
  if (apart) {
    if (first == second) return false;
    if (apart_[first].insert(second).second) ++weight_[first];
    if (apart_[second].insert(first).second) ++weight_[second];
    return true;
  }
  if (apart_[first].contains(second)) return false;
  if (first == second) return true;
  if (weight_[first] < weight_[second]) std::swap(first, second);
  unite(first, second);
  return true;
}

void TopicGroups::unite(size_t into, size_t from) {
  parent_[from] = into;
  weight_[into] += weight_[from];
  for (const size_t other : apart_[from]) {
    ++steps_;
    apart_[other].erase(from);
    apart_[other].insert(into);
    apart_[into].insert(other);
  }
  apart_[from].clear();
}

size_t TopicGroups::indexOf(const Topic& topic) {
  const auto [at, is_new] = indices_.try_emplace(topic, parent_.size());
  if (is_new) {
    parent_.push_back(at->second);
    weight_.push_back(1);
    apart_.emplace_back();
  }
  return at->second;
}

size_t TopicGroups::rootOf(const Topic& topic) {
  size_t root = indexOf(topic);
  for (; parent_[root] != root; root = parent_[root]) {
    ++steps_;
    parent_[root] = parent_[parent_[root]];
  }
  return root;
}

}  // namespace shoal::mapping
