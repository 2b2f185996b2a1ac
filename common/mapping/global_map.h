// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "shoal/world/ids.h"

namespace shoal::mapping {

/// A column of bricks, named by x and y of their index.
using BrickColumn = std::pair<int32_t, int32_t>;
/// The one that holds a cell: floor division by kBrickEdge.
inline BrickColumn brickColumnOf(const world::CellIndex& cell) { return {cell.x >> 4, cell.y >> 4}; }

/// A cell of the fused map, as the robot that saw it last labels it.
struct GlobalCell {
  world::CellIndex cell;
  world::GlobalLabel label{};
  world::RobotId robot{};
  world::Timestamp seen;
  float certainty = 0;  ///< in [0, 1]; 0 while it has not been heard
  bool operator==(const GlobalCell&) const = default;
};

/// "This robot's topic is that label."
struct Correspondence {
  world::RobotId robot{};
  world::TopicId topic{};
  world::GlobalLabel label{};
  auto operator<=>(const Correspondence&) const = default;
};

/// A row of the legend.
struct LabelSummary {
  world::GlobalLabel label{};
  std::string name;  ///< given by the operator, else empty
  int64_t cells = 0;
  std::vector<world::RobotId> robots;  ///< whose topics it joins, ascending
  world::Timestamp first_seen;         ///< creation of its oldest topic
  bool operator==(const LabelSummary&) const = default;
};

/// One consistent map of everything heard. A pure function of the replicated state and the fusion options.
struct GlobalMap {
  std::vector<GlobalCell> cells;                ///< ascending by cell
  std::vector<Correspondence> correspondences;  ///< ascending by robot, topic
  std::vector<LabelSummary> labels;             ///< ascending by label; only those with cells
  uint64_t state_digest = 0;                    ///< of the state it was made from

  /// Digest of cells and correspondences: mapDigest() of the sum over cells of cellHash() x labelFactor().
  uint64_t digest() const;
};

/// A hash of all that a cell shows but its label.
uint64_t cellHash(const world::CellIndex& cell, world::RobotId robot, world::Timestamp seen, float certainty);

/// What a cell's hash is multiplied by for its label, modulo 2^64; odd. A sum over cells, so that whoever
/// knows the sum of every topic's cells has the digest after a new matching without looking at them again.
uint64_t labelFactor(world::GlobalLabel label);

/// The digest of a map from the sum over its cells.
uint64_t mapDigest(uint64_t sum_of_cells, const std::vector<Correspondence>& correspondences);

}  // namespace shoal::mapping
