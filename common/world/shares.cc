// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "shoal/world/survey.h"

namespace shoal::world {
namespace {

/// The border between two cells that lies nearest to p, metres: (i + 1/2) x size.
double nearestBorder(double p, const Grid& grid) {
  return (std::round(p / grid.cellSize() - 0.5) + 0.5) * grid.cellSize();
}

/// Cuts [low, high] at the cell borders nearest to the given fractions of it.
/// @throws std::invalid_argument when two cuts meet: fewer cells than parts.
std::vector<double> cuts(double low, double high, const std::vector<double>& fractions, const Grid& grid) {
  std::vector<double> at{low};
  for (const double fraction : fractions) at.push_back(nearestBorder(low + fraction * (high - low), grid));
  at.push_back(high);
  for (size_t i = 1; i < at.size(); ++i) {
    if (at[i] > at[i - 1]) continue;
    throw std::invalid_argument("cells of " + std::to_string(grid.cellSize()) + " m are too large to cut " +
                                std::to_string(high - low) + " m between " +
                                std::to_string(fractions.size() + 1) +
                                " robots; use fewer robots or smaller cells");
  }
  return at;
}

/// Robots per row, top row first: as equal as can be, the fuller rows spread evenly.
std::vector<int> robotsPerRow(int num_robots, int rows) {
  std::vector<int> count;
  for (int row = 0; row < rows; ++row) {
    count.push_back((row + 1) * num_robots / rows - row * num_robots / rows);
  }
  return count;
}

/// Sum over the shares of the longer edge over the shorter: what chooses the number of rows.
double elongation(double width, double height, int num_robots, int rows) {
  double sum = 0.0;
  for (const int columns : robotsPerRow(num_robots, rows)) {
    const double share_width = width / columns, share_height = height * columns / num_robots;
    sum += columns * std::max(share_width / share_height, share_height / share_width);
  }
  return sum;
}

}  // namespace

std::vector<Extent> shares(const Extent& extent, int num_robots, const Grid& grid) {
  if (num_robots < 1) {
    throw std::invalid_argument("num_robots must be >= 1, got " + std::to_string(num_robots));
  }
  const double width = extent.max_x - extent.min_x, height = extent.max_y - extent.min_y;
  int rows = 1;
  for (int candidate = 2; candidate <= num_robots; ++candidate) {
    const double gain =
        elongation(width, height, num_robots, rows) - elongation(width, height, num_robots, candidate);
    if (gain > 1e-9) rows = candidate;
  }
  const std::vector<int> columns = robotsPerRow(num_robots, rows);

  std::vector<double> below;  // cuts from the south: the last row first
  int robots_below = 0;
  for (int row = rows - 1; row > 0; --row) {
    robots_below += columns[static_cast<size_t>(row)];
    below.push_back(static_cast<double>(robots_below) / num_robots);
  }
  const std::vector<double> y = cuts(extent.min_y, extent.max_y, below, grid);

  std::vector<Extent> team;
  for (int row = 0; row < rows; ++row) {
    const int num_columns = columns[static_cast<size_t>(row)];
    std::vector<double> left;
    for (int column = 1; column < num_columns; ++column)
      left.push_back(static_cast<double>(column) / num_columns);
    const std::vector<double> x = cuts(extent.min_x, extent.max_x, left, grid);
    const size_t south = static_cast<size_t>(rows - 1 - row);
    for (size_t column = 0; column + 1 < x.size(); ++column) {
      team.push_back({x[column], y[south], x[column + 1], y[south + 1]});
    }
  }
  return team;
}

}  // namespace shoal::world
