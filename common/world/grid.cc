// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/grid.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace shoal::world {

Grid::Grid(double cell_size_m) : cell_size_m_(cell_size_m) {
  if (!(cell_size_m > 0.0) || !std::isfinite(cell_size_m)) {
    throw std::invalid_argument("cell size must be finite and > 0 m, got " + std::to_string(cell_size_m));
  }
}

CellIndex Grid::cellOf(const Eigen::Vector3d& p_in_world) const {
  const auto index = [this](double p) { return static_cast<int32_t>(std::floor(p / cell_size_m_ + 0.5)); };
  return {index(p_in_world.x()), index(p_in_world.y()), index(p_in_world.z())};
}

Eigen::Vector3d Grid::centerOf(const CellIndex& cell) const {
  return Eigen::Vector3d(cell.x, cell.y, cell.z) * cell_size_m_;
}

}  // namespace shoal::world
