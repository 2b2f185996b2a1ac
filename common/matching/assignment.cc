// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/assignment.h"

#include <limits>
#include <stdexcept>
#include <string>

namespace shoal::matching {

std::vector<int> assign(const Eigen::MatrixXd& cost) {
  const Eigen::Index num_rows = cost.rows();
  const Eigen::Index num_columns = cost.cols();
  if (num_rows > num_columns) {
    throw std::invalid_argument("an assignment needs at least as many columns as rows, got " +
                                std::to_string(num_rows) + " rows and " + std::to_string(num_columns) +
                                " columns");
  }
  if (!cost.allFinite()) throw std::invalid_argument("every cost of an assignment must be finite");

  constexpr Eigen::Index kNone = -1;
  const auto at = [](auto& values, Eigen::Index i) -> decltype(auto) {
    return values[static_cast<size_t>(i)];
  };
  const auto columns = static_cast<size_t>(num_columns);
  // Duals: cost(i, j) - u_i - v_j >= 0, and 0 on the assignment.
  std::vector<double> u(static_cast<size_t>(num_rows), 0.0);
  std::vector<double> v(columns, 0.0);
  std::vector<Eigen::Index> row_of(columns, kNone);

  // Adds one row at a time along the shortest augmenting path, by Dijkstra over the columns.
  for (Eigen::Index start = 0; start < num_rows; ++start) {
    std::vector<double> distance(columns, std::numeric_limits<double>::infinity());
    std::vector<Eigen::Index> before(columns, kNone);  // the column that the path came from
    std::vector<bool> settled(columns, false);
    Eigen::Index row = start;
    Eigen::Index column = kNone;
    double reached = 0.0;
    while (row != kNone) {
      Eigen::Index nearest = kNone;
      for (Eigen::Index j = 0; j < num_columns; ++j) {
        if (at(settled, j)) continue;
        const double through = reached + (cost(row, j) - at(u, row) - at(v, j));
        if (through < at(distance, j)) {
          at(distance, j) = through;
          at(before, j) = column;
        }
        if (nearest == kNone || at(distance, j) < at(distance, nearest)) nearest = j;
      }
      column = nearest;
      reached = at(distance, column);
      settled[static_cast<size_t>(column)] = true;
      row = at(row_of, column);
    }
    for (Eigen::Index j = 0; j < num_columns; ++j) {
      if (!settled[static_cast<size_t>(j)]) continue;
      const double slack = reached - at(distance, j);
      at(v, j) -= slack;
      if (at(row_of, j) != kNone) at(u, at(row_of, j)) += slack;
    }
    at(u, start) += reached;
    while (column != kNone) {
      const Eigen::Index previous = at(before, column);
      at(row_of, column) = previous == kNone ? start : at(row_of, previous);
      column = previous;
    }
  }

  std::vector<int> column_of(static_cast<size_t>(num_rows));
  for (Eigen::Index j = 0; j < num_columns; ++j) {
    if (at(row_of, j) != kNone) at(column_of, at(row_of, j)) = static_cast<int>(j);
  }
  return column_of;
}

}  // namespace shoal::matching
