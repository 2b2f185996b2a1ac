// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "operator_console/render.h"
#include "shoal/eval/evaluation.h"

namespace shoal::console {

/// A run scored against its world, and what is needed to draw the truth beside its map.
struct Evaluation {
  nlohmann::ordered_json json() const;  ///< as `evaluate --json` prints it

  double cell_size_m = 1;
  double coverage = 0;  ///< fraction of the world's ground columns that the team's map has
  std::vector<matching::MatcherOptions> matchers;
  std::vector<eval::Score> scores;  ///< per matcher
  std::optional<eval::Score> single;
  TruthPicture truth;
};

/// Scores a run's local maps under each option set. `world` must outlive the result, whose truth asks it.
/// @throws std::runtime_error naming what is missing or broken in the run.
Evaluation evaluateRun(const std::string& dir, const world::World& world, double cell_size_m,
                       const std::vector<matching::MatcherOptions>& matchers);

/// The table that people read.
std::string scoreTable(const Evaluation& evaluation);

}  // namespace shoal::console
