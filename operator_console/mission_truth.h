// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "operator_console/mission_sources.h"
#include "shoal/eval/evaluation.h"
#include "shoal/world/place.h"

namespace shoal::console {

/// Where a mission takes place, as far as its own files do not say it.
struct TruthHint {
  std::string world;  ///< empty: what the summary of a finished run says
  uint64_t seed = 1;  ///< for missions without a summary, as robots and observations
  int robots = 0;     ///< 0: those that were heard
  int32_t observations = 0;
};

/// What is really there.
struct MissionTruth {
  std::shared_ptr<const world::Place> place;  ///< of_cell looks into it
  eval::TruthOfCell of_cell;
};

/// The world of a mission: the hint's, or that of a run's summary; empty when neither is known.
std::string worldOf(const Where& where, const TruthHint& hint);

/// The truth of a mission's cells. Of recorded cameras it is projected from the frames that the team has
/// seen.
/// @throws std::runtime_error when the world has no labels; std::invalid_argument when it cannot be opened.
MissionTruth truthOf(const Where& where, const mapping::MissionView& view, const TruthHint& hint);

}  // namespace shoal::console
