// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shoal/eval/evaluation.h"
#include "shoal/mapping/local_belief.h"

namespace shoal::eval {

/// Which robot's label a cell shows when several robots saw it.
enum class FusionRule {
  kNewestWins,   ///< the robot that saw it last, then the higher robot number (Jamieson et al. 2021, §III)
  kConcatenate,  ///< each of them: the cell counts once per robot, as the paper's own code does
};

/// How often one robot's topic meets each true class.
struct TopicTally {
  world::RobotId robot{};
  world::TopicId topic{};
  std::vector<int64_t> cells_of_class;  ///< one entry a class
  int64_t cells = 0;                    ///< cells that it labels, with or without truth
};

/// The topics of a team against the truth: all that any matching of them can be scored by, without going over
/// the cells again.
struct TeamTally {
  std::vector<TopicTally> topics;  ///< those that label a cell, ascending by robot, topic
  int num_classes = 0;             ///< 1 + the highest class met
};

TeamTally tally(std::span<const mapping::LocalBelief> team, const TruthOfCell& truth, FusionRule rule);

/// Scores one label per topic of the tally, any numbers.
Score score(const TeamTally& tally, std::span<const int> label);

/// The class that most cells of each topic belong to, ties to the lowest id; -1 for a topic without truth:
/// the labels of an oracle, no matcher that keeps topics whole can label more cells rightly.
std::vector<int> majorityClasses(const TeamTally& tally);

/// The share of the cells with truth whose topic has their class as its majority, in [0, 1].
double purity(const TeamTally& tally);

}  // namespace shoal::eval
