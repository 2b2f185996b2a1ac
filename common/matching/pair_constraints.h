// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "shoal/matching/clustering.h"

namespace shoal::matching {

/// What a clustering must respect, as pairs of vertices.
struct PairConstraints {
  std::vector<std::pair<int, int>> together;  ///< joined before anything else, transitively
  std::vector<std::pair<int, int>> apart;     ///< never in one cluster

  bool empty() const { return together.empty() && apart.empty(); }
};

/// The vertices with those that must be together made one.
struct Contraction {
  std::vector<int> group;                  ///< per vertex, numbered by first appearance from 0
  std::vector<std::vector<int>> members;   ///< per group its vertices, ascending
  std::vector<std::pair<int, int>> apart;  ///< groups g < h, ascending, each pair once

  int numGroups() const { return static_cast<int>(members.size()); }
};

/// @throws std::invalid_argument naming a pair that is not of two vertices in [0, n), or that must be both
/// together and apart.
/// Cost: O((n + pairs) log n).
Contraction contract(int n, const PairConstraints& constraints);

/// Which groups may not have one label: those of Contraction::apart and, when vertices of one robot are to
/// stay apart, groups that hold vertices of one robot.
class Conflicts {
 public:
  /// @param owner  per vertex its robot, or empty when robots do not matter.
  Conflicts(const Contraction& contraction, std::span<const int> owner);

  /// The groups that may not share a label with `group`, ascending.
  const std::vector<int>& of(int group) const { return of_[static_cast<size_t>(group)]; }
  bool between(int group, int other) const;

 private:
  std::vector<std::vector<int>> of_;
};

/// The same constraints among a subset of the vertices, conflicts that come of robots included. What two of
/// them must be by way of a third that is left out stays.
/// @param place  per vertex its place among those kept, or -1.
PairConstraints restrict(const Contraction& contraction, const Conflicts& conflicts,
                         std::span<const int> place);

/// Labels for all vertices where only some were matched: a vertex that was left out gets the label of those
/// it must be together with, or a new one.
/// @param matched  of the vertices with place >= 0, by place; restrict() was honoured.
Clustering extend(const Contraction& contraction, std::span<const int> place, const Clustering& matched);

/// Makes any clustering honour the constraints, for matchers that know nothing of them. All of a group get
/// the label of its first vertex. Then, in order of first vertices, a group that may not share its label with
/// an earlier one gets a new label.
/// @param owner  per vertex its robot, when groups of one robot must be apart too; else empty.
/// Cost: O(n + Σ over labels of the square of the groups that have it).
Clustering repair(const Contraction& contraction, const Clustering& clustering, std::span<const int> owner);

}  // namespace shoal::matching
