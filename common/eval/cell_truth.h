// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "shoal/world/grid.h"
#include "shoal/world/observation.h"
#include "shoal/world/place.h"

namespace shoal::eval {

/// The true class of every cell, gathered by projecting labelled frames: every pixel with a valid depth votes
/// in the cell it falls into. 255 = unlabelled.
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
  struct Count {
    uint8_t id = 0;
    int32_t pixels = 0;
  };
  struct Votes {
    std::vector<Count> of_class;  // in any order: few classes meet in a cell
    int32_t unlabelled = 0;
    void add(uint8_t id, int32_t pixels);
  };
  world::Grid grid_;
  std::unordered_map<world::CellIndex, Votes, world::CellHash> votes_;  // looked up; sums only
};

/// The true class of a cell of a flat, fully labelled picture; nothing where it is not labelled.
std::optional<int> flatTruth(const world::Place& place, const world::Grid& grid,
                             const world::CellIndex& cell);

}  // namespace shoal::eval
