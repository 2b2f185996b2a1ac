// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "shoal/world/ids.h"

namespace shoal::world {

/// Cubic cells of one size; a cell is centred at index x cell size (round to nearest).
class Grid {
 public:
  /// @throws std::invalid_argument unless cell_size_m is finite and > 0.
  explicit Grid(double cell_size_m);

  double cellSize() const { return cell_size_m_; }

  /// The cell that holds a finite point (metres, world). Half-way points go up: floor(p / size + 1/2).
  /// The caller keeps |p / size| below 2^31.
  CellIndex cellOf(const Eigen::Vector3d& p_in_world) const;

  /// Centre of a cell, metres, world.
  Eigen::Vector3d centerOf(const CellIndex& cell) const;

 private:
  double cell_size_m_;
};

}  // namespace shoal::world
