// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "operator_console/render.h"
#include "shoal/eval/evaluation.h"
#include "shoal/eval/explanation.h"

namespace shoal::console {

/// A run scored against its world, and what is needed to draw the truth beside its map.
struct Evaluation {
  nlohmann::ordered_json json() const;  ///< as `evaluate --json` prints it

  double cell_size_m = 1;
  double coverage = 0;  ///< fraction of the world's ground columns that the team's map has
  std::vector<matching::MatcherOptions> matchers;
  std::vector<eval::Score> scores;       ///< per matcher
  std::vector<double> ami_concatenated;  ///< per matcher, with a cell counted once for each robot that saw it
  std::optional<eval::Score> single;
  std::optional<eval::Explanation> explanation;  ///< of the last matcher, when it was asked for
  TruthPicture truth;
};

/// How the team of a finished mission flew, from its summary.json.
/// @throws std::runtime_error naming what is missing or of the wrong type.
world::SurveyOptions teamOf(const nlohmann::ordered_json& summary);

/// The camera that it was given besides those of the place, if any, from its summary.json.
std::optional<world::Camera> cameraOf(const nlohmann::ordered_json& summary);

/// Says on stderr when a run, by its summary.json, was flown over another world than it is scored against.
void warnOfOtherWorld(const std::string& run, const nlohmann::ordered_json& summary,
                      const std::string& world);

/// Scores a run's local maps under each option set. `place` must outlive the result, whose truth asks it.
/// @param team  as it flew: completed() for that place.
/// @throws std::runtime_error naming what is missing or broken in the run.
Evaluation evaluateRun(const std::string& dir, const world::Place& place, const world::SurveyOptions& team,
                       const std::vector<matching::MatcherOptions>& matchers, bool explain = false);

/// The table that people read.
std::string scoreTable(const Evaluation& evaluation);

}  // namespace shoal::console
