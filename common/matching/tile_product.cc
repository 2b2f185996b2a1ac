// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/tile_product.h"

#include <algorithm>

#include "shoal/demand.h"

namespace shoal::matching {

void multiply(const Eigen::SparseMatrix<double>& matrix, const Tile& x, Tile& result) {
  SHOAL_DEMAND(matrix.isCompressed() && matrix.cols() == x.rows() && &x != &result);
  using Row = Eigen::Array<double, kTileWidth, 1>;
  result.resize(x.rows(), kTileWidth);
  const auto* const first = matrix.outerIndexPtr();
  const auto* const neighbour = matrix.innerIndexPtr();
  const double* const value = matrix.valuePtr();
  for (Eigen::Index i = 0; i < matrix.cols(); ++i) {
    Row sum = Row::Zero();
    for (auto k = first[i]; k < first[i + 1]; ++k) {
      sum += value[k] * Row::Map(x.data() + Eigen::Index{kTileWidth} * neighbour[k]);
    }
    Row::Map(result.data() + Eigen::Index{kTileWidth} * i) = sum;
  }
}

Eigen::MatrixXd multiply(const Eigen::SparseMatrix<double>& matrix, const Eigen::MatrixXd& x) {
  Eigen::MatrixXd result(x.rows(), x.cols());
  Tile tile(x.rows(), kTileWidth);
  Tile image;
  for (Eigen::Index first = 0; first < x.cols(); first += kTileWidth) {
    const Eigen::Index width = std::min<Eigen::Index>(kTileWidth, x.cols() - first);
    tile.leftCols(width) = x.middleCols(first, width);
    tile.rightCols(kTileWidth - width).setZero();
    multiply(matrix, tile, image);
    result.middleCols(first, width) = image.leftCols(width);
  }
  return result;
}

}  // namespace shoal::matching
