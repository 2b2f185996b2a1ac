// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace shoal::matching {

/// Gives every row a column of its own so that the sum of the costs is least.
///
/// Exact for costs that are whole numbers up to 2^50 / rows; so callers who must decide ties the same way
/// everywhere round first. Among equally good assignments the choice is a fixed function of `cost`.
///
/// @param cost  r×c, finite, r <= c.
/// @returns per row its column; r distinct values in [0, c).
/// @throws std::invalid_argument for more rows than columns, or a cost that is not finite.
///
/// Cost: O(r² c). Source: H. W. Kuhn 1955 in the shortest-augmenting-path form, R. Jonker and A. Volgenant,
/// Computing 38, 1987.
std::vector<int> assign(const Eigen::MatrixXd& cost);

}  // namespace shoal::matching
