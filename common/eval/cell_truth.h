// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>

#include "shoal/world/grid.h"
#include "shoal/world/observation.h"
#include "shoal/world/world.h"

namespace shoal::eval {

/// The true class of every cell, gathered by projecting labelled frames: every pixel with a valid depth votes
/// in the cell it falls into.
class ProjectedTruth {
 public:
  explicit ProjectedTruth(const world::Grid& grid) : grid_(grid) {}

  /// Adds the votes of one frame. A frame without labels adds nothing.
  void add(const world::Observation& frame);
  void add(const ProjectedTruth& other);

  /// The class with most votes (ties to the lowest id); nothing where no pixel fell or fewer than half of the
  /// pixels that fell are labelled.
  std::optional<int> at(const world::CellIndex& cell) const;

 private:
  struct Votes {
    std::array<int32_t, 32> of_class{};  // classes 0..31; Worlds have fewer
    int32_t unlabelled = 0;
  };
  world::Grid grid_;
  std::unordered_map<world::CellIndex, Votes, world::CellHash> votes_;  // looked up; sums only
};

/// The true class of a cell of a flat, fully labelled picture; nothing where it is not labelled.
std::optional<int> flatTruth(const world::World& world, const world::Grid& grid,
                             const world::CellIndex& cell);

}  // namespace shoal::eval
