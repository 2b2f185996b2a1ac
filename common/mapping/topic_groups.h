// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "shoal/world/ids.h"

namespace shoal::mapping {

/// A topic of the present epoch.
using Topic = std::pair<world::RobotId, world::TopicId>;

/// Which topics are one thing by links alone, and which of these groups are not the same. Links are
/// transitive; what was set apart stays apart, and so does all that is linked to either.
///
/// Cost of n calls of add(): O(n log^2 n), whatever they say. Groups are united small into large, with what
/// they stay apart from.
class TopicGroups {
 public:
  /// Links two topics, or sets them apart.
  /// @returns false, and changes nothing, when that contradicts what was added before.
  bool add(const Topic& a, const Topic& b, bool apart);

  /// Steps taken up to now: parents followed, groups told that one they stay apart from has a new root.
  size_t steps() const { return steps_; }

 private:
  size_t indexOf(const Topic& topic);
  size_t rootOf(const Topic& topic);
  void unite(size_t into, size_t from);

  std::map<Topic, size_t> indices_;
  std::vector<size_t> parent_;
  std::vector<size_t> weight_;           // of a root: its topics, and how often it was set apart
  std::vector<std::set<size_t>> apart_;  // of a root: the roots that it stays apart from, and they from it
  size_t steps_ = 0;
};

}  // namespace shoal::mapping
