// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "shoal/mapping/local_belief.h"
#include "shoal/mapping/poses_file.h"
#include "shoal/matching/matcher.h"
#include "shoal/world/world.h"

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
  std::vector<std::vector<mapping::StampedPose>> paths;  ///< per robot, for truth by projection
  std::optional<mapping::LocalBelief> single;            ///< one robot that explored the same area
};

/// Reads `DIR/robots/R*/` and, when it is there, `DIR/single/`.
/// @throws std::runtime_error naming what is missing or broken.
Run readRun(const std::string& dir, const world::Grid& grid);

/// A cell's true class, when it has one.
using TruthOfCell = std::function<std::optional<int>(const world::CellIndex&)>;

/// The truth of a world: its own label picture, or the labels of the frames rendered along the run's paths
/// (both cores). `world` must outlive the result.
TruthOfCell truthFor(const world::World& world, const world::Grid& grid, const Run& run,
                     const world::Intrinsics& intrinsics);

/// Scores labelled cells against the truth.
Score score(const std::vector<std::pair<world::CellIndex, int>>& labels, const TruthOfCell& truth);

/// Matches the run's beliefs anew with each option set and scores the fused maps, in the order given.
std::vector<Score> scoreMatchers(const Run& run, const std::vector<matching::MatcherOptions>& matchers,
                                 const TruthOfCell& truth);

/// Scores the single robot's own labels.
Score scoreSingle(const mapping::LocalBelief& single, const TruthOfCell& truth);

/// The option sets of the paper's table that are built: ID, sequential Hungarian on L2, CLEAR on cosine .75.
std::vector<matching::MatcherOptions> allMatchers();

/// Fraction of the cell columns of the world's extent that hold a cell.
double coverageOf(const std::vector<world::CellIndex>& cells, const world::World& world,
                  const world::Grid& grid);

}  // namespace shoal::eval
