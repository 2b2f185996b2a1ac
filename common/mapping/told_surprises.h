// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "shoal/mapping/belief_store.h"
#include "shoal/mapping/global_map.h"

namespace shoal::mapping {

/// What robots told of surprises, by place, so that a part of the map is looked up at the cost of that part.
/// surprisesOf() is the same of the whole map.
class ToldSurprises {
 public:
  /// Brings it up to date. @param beliefs  Always the same state, grown since; or a new one's first.
  /// Cost: O(cells of the certainties that changed).
  void update(const BeliefStore& beliefs);

  /// A robot told of a cell. @param steps  as of() gives them, > 0.
  void tell(world::RobotId robot, const world::CellIndex& cell, uint8_t steps);

  /// Of each cell what the robot whose cell it is told, in steps of 1 / kSurpriseStepsPerUnit; 0: nothing.
  /// @param cells  ascending by cell.
  /// Cost: O(cells), and a search for each surprise in their columns of bricks.
  std::vector<uint8_t> of(std::span<const GlobalCell> cells) const;

  /// A hash of all that is told in a column of bricks; 0 for nothing.
  uint64_t hashOf(const BrickColumn& column) const;

 private:
  using Brick = std::pair<world::RobotId, int32_t>;  // and its z
  using Told = std::map<world::CellIndex, uint8_t>;

  void forget(world::RobotId robot);

  std::map<BrickColumn, std::map<Brick, Told>> told_;
  std::map<world::RobotId, int32_t> epochs_;
  uint64_t revision_ = 0;
};

}  // namespace shoal::mapping
