// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/constrained_clear.h"

#include <algorithm>
#include <set>

#include "shoal/demand.h"
#include "shoal/matching/assignment.h"
#include "shoal/matching/clear_embedding.h"
#include "shoal/matching/contracted_graph.h"
#include "shoal/matching/spectrum.h"

namespace shoal::matching {
namespace {

constexpr double kScoreOne = 1e9;  // a score of 1

// The groups that come to their robot first: each group once, with the first robot that has it.
std::vector<std::vector<int>> groupsByRobot(const AssociationGraph& graph, const Contraction& contraction,
                                            int& most) {
  std::vector<std::vector<int>> groups;
  std::set<int> met;
  auto group = contraction.group.begin();
  most = 0;
  for (const int num_topics : graph.num_topics) {
    const std::set<int> own(group, group + num_topics);
    group += num_topics;
    most = std::max(most, static_cast<int>(own.size()));
    std::vector<int>& fresh = groups.emplace_back();
    for (const int g : own)
      if (met.insert(g).second) fresh.push_back(g);
  }
  return groups;
}

// Chooses centres for groups that must all differ (or for one group): best total score without those that are
// taken; columns from `num_columns` on are new labels, one for each. A group that finds centres taken rather
// opens a label than goes to a centre it has nothing in common with.
std::vector<int> choose(const std::vector<int>& groups, const std::vector<Place>& place, int num_columns,
                        const std::vector<std::set<int>>& taken) {
  const auto rows = static_cast<Eigen::Index>(groups.size());
  const double taken_cost =
      static_cast<double>(rows + 1) * (2 * kScoreOne + 1);  // dearer than all labels new
  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(rows, num_columns + rows, kScoreOne);
  cost.rightCols(rows).setConstant(2 * kScoreOne + 1);
  for (Eigen::Index r = 0; r < rows; ++r) {
    const Place& at = place[static_cast<size_t>(groups[static_cast<size_t>(r)])];
    for (size_t k = 0; k < at.numScores(); ++k) cost(r, at.column(k)) -= at.score(k);
    if (!taken[static_cast<size_t>(r)].empty()) cost.row(r).tail(rows).setConstant(kScoreOne - 1);
    for (const int column : taken[static_cast<size_t>(r)])
      if (column < num_columns) cost(r, column) = taken_cost;
  }
  std::vector<int> chosen = assign(cost);
  for (size_t r = 0; r < chosen.size(); ++r)
    SHOAL_DEMAND(chosen[r] >= num_columns || !taken[r].contains(chosen[r]));
  return chosen;
}

}  // namespace

Clustering rectifyConstrained(const AssociationGraph& graph, const ClearOptions& options,
                              const PairConstraints& constraints, SpectrumMemory* memory) {
  check(graph);
  const Contraction contraction = contract(graph.numVertices(), constraints);
  if (contraction.group.empty()) return {};
  const Conflicts conflicts(contraction, options.distinct ? owners(graph) : std::vector<int>{});
  int most = 0;
  const std::vector<std::vector<int>> by_robot = groupsByRobot(graph, contraction, most);

  const SmallEnd end = smallEnd(normalizedLaplacian(contractedGraph(graph, contraction, conflicts), false),
                                options.eigenvalue_threshold - options.eigenvalue_tolerance,
                                options.distinct ? most : 0, memory);
  const std::vector<Embedding> embeddings = embed(end);
  const std::vector<Place> place = places(embeddings, contraction.numGroups());

  std::vector<int> column(contraction.members.size(), -1);
  int num_labels = end.num_kept;
  const auto settle = [&](const std::vector<int>& groups) {
    if (groups.empty()) return;
    std::vector<std::set<int>> taken;
    for (const int g : groups) {
      std::set<int>& columns = taken.emplace_back();
      for (const int other : conflicts.of(g)) {
        if (column[static_cast<size_t>(other)] >= 0) columns.insert(column[static_cast<size_t>(other)]);
      }
    }
    const std::vector<int> chosen = choose(groups, place, end.num_kept, taken);
    for (size_t r = 0; r < groups.size(); ++r) {
      column[static_cast<size_t>(groups[r])] = chosen[r] < end.num_kept ? chosen[r] : num_labels++;
    }
  };
  for (const std::vector<int>& groups : by_robot) {
    if (options.distinct) {
      settle(groups);
    } else {
      for (const int g : groups) settle({g});
    }
  }
  std::vector<int> label;
  for (const int g : contraction.group) label.push_back(column[static_cast<size_t>(g)]);
  return numberByFirstAppearance(label, num_labels);
}

}  // namespace shoal::matching
