// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace shoal::matching {

/// Eight vectors side by side: a row is one cache line.
inline constexpr int kTileWidth = 8;
using Tile = Eigen::Matrix<double, Eigen::Dynamic, kTileWidth, Eigen::RowMajor>;

/// matrix · x for eight vectors at once. One pass over the matrix serves all, and ten thousand rows of a tile
/// stay in a second-level cache of a megabyte: a product of eight costs about what a product of one does.
///
/// Every entry is summed over ascending columns by itself, so it does not depend on the machine's vectors.
///
/// @param matrix  s×s, symmetric, compressed; both triangles are stored.
/// @param x       s×8.
/// @param result  s×8, overwritten; not x.
/// Cost: 16 flops per stored entry.
void multiply(const Eigen::SparseMatrix<double>& matrix, const Tile& x, Tile& result);

/// The same for any number of vectors, the columns of `x`.
Eigen::MatrixXd multiply(const Eigen::SparseMatrix<double>& matrix, const Eigen::MatrixXd& x);

}  // namespace shoal::matching
