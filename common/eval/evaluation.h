// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "shoal/mapping/local_belief.h"
#include "shoal/matching/matcher.h"
#include "shoal/world/place.h"

namespace shoal::eval {

/// How well one map agrees with the truth, over the cells that have both.
struct Score {
  double ami = 0;      ///< adjusted mutual information, max-normalised; may be negative
  double nmi = 0;      ///< mutual information over the larger entropy, in [0, 1]
  int64_t cells = 0;   ///< cells of the map
  int64_t scored = 0;  ///< of these, cells with truth
  int labels = 0;      ///< labels in the map
  int classes = 0;     ///< classes among the scored cells
};

/// A finished run as its files tell it.
struct Run {
  std::vector<mapping::LocalBelief> robots;
  std::optional<mapping::LocalBelief> single;  ///< one robot that explored the same area
};

/// Reads `DIR/robots/R*/` and, when it is there, `DIR/single/`.
/// @throws std::runtime_error naming what is missing or broken.
Run readRun(const std::string& dir, const world::Grid& grid);

/// A cell's true class, when it has one.
using TruthOfCell = std::function<std::optional<int>(const world::CellIndex&)>;

/// The truth of a place: its own label picture where the ground is flat, else the labels of the frames that a
/// team sees, projected into cells from where they were truly taken (a team on two threads; sums, so that the
/// order does not matter). `place` must outlive the result.
/// @throws std::invalid_argument as Place::source().
TruthOfCell truthFor(const world::Place& place, const world::SurveyOptions& team, const world::Grid& grid);

/// Scores labelled cells against the truth.
Score score(const std::vector<std::pair<world::CellIndex, int>>& labels, const TruthOfCell& truth);

/// Matches the run's beliefs anew with each option set and scores the fused maps, in the order given.
std::vector<Score> scoreMatchers(const Run& run, const std::vector<matching::MatcherOptions>& matchers,
                                 const TruthOfCell& truth);

/// Scores the single robot's own labels.
Score scoreSingle(const mapping::LocalBelief& single, const TruthOfCell& truth);

/// The option sets of the paper's table that are built: ID, sequential Hungarian on L2, CLEAR on cosine .75.
std::vector<matching::MatcherOptions> allMatchers();

/// Fraction of the cell columns of the place's extent (those whose centre lies inside) that hold a cell; of
/// a recording, which has no extent, of the columns that the team's depth images reach.
double coverageOf(const std::vector<world::CellIndex>& cells, const world::Place& place,
                  const world::SurveyOptions& team, const world::Grid& grid);

}  // namespace shoal::eval
