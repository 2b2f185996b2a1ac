// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/eigenpairs.h"

#include <Eigen/Eigenvalues>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "shoal/demand.h"
#include "shoal/matching/block_krylov.h"
#include "shoal/matching/count_certificate.h"
#include "shoal/matching/tile_product.h"
#include "shoal/matching/tridiagonal.h"
#include "shoal/matching/tridiagonal_spectrum.h"

namespace shoal::matching {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kResidual = 1e-11;

// The residual |A v - θ v| of every pair; `image` holds the A v.
VectorXd residuals(const MatrixXd& image, const Eigenpairs& pairs) {
  return (image - pairs.vectors * pairs.values.asDiagonal()).colwise().norm().transpose();
}

bool isOrthonormal(const MatrixXd& vectors) {
  MatrixXd gram = vectors.transpose() * vectors;
  gram.diagonal().array() -= 1.0;
  return gram.size() == 0 || gram.cwiseAbs().maxCoeff() <= kResidual;
}

Eigenpairs byFullDecomposition(const MatrixXd& matrix, double bound) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(matrix);
  SHOAL_DEMAND(solver.info() == Eigen::Success);
  const Index count = (solver.eigenvalues().array() > bound).count();
  return {solver.eigenvalues().tail(count).reverse(),
          solver.eigenvectors().rightCols(count).rowwise().reverse()};
}

Eigenpairs descending(const Eigenpairs& pairs) {
  std::vector<Index> order(static_cast<size_t>(pairs.values.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](auto a, auto b) { return pairs.values[a] > pairs.values[b]; });
  return {pairs.values(order), pairs.vectors(Eigen::all, order)};
}

void append(Eigenpairs& pairs, const Eigenpairs& more) {
  const Index old = pairs.values.size();
  pairs.values.conservativeResize(old + more.values.size());
  pairs.values.tail(more.values.size()) = more.values;
  pairs.vectors.conservativeResize(Eigen::NoChange, old + more.values.size());
  pairs.vectors.rightCols(more.values.size()) = more.vectors;
}

}  // namespace

Eigenpairs denseEigenpairsAbove(const MatrixXd& matrix, double bound) {
  const Index size = matrix.rows();
  if (size < 3) return byFullDecomposition(matrix, bound);
  const Tridiagonal t = tridiagonalize(matrix);
  const int count = countAbove(t.diagonal, t.off_diagonal, bound);
  if (2 * count > size) return byFullDecomposition(matrix, bound);
  Eigenpairs pairs;
  pairs.values = greatestEigenvalues(t.diagonal, t.off_diagonal, count);
  pairs.vectors = inverseIteration(t.diagonal, t.off_diagonal, pairs.values);
  t.lift(pairs.vectors);
  const bool good =
      isOrthonormal(pairs.vectors) && (residuals(matrix * pairs.vectors, pairs).array() <= kResidual).all();
  return good ? pairs : byFullDecomposition(matrix, bound);
}

std::optional<Eigenpairs> krylovEigenpairsAbove(const Eigen::SparseMatrix<double>& matrix, double bound) {
  if (bound <= 0.0) return std::nullopt;
  Eigenpairs found{VectorXd(0), MatrixXd(matrix.rows(), 0)};
  Rest rest = Rest::kAbove;
  for (uint64_t round = 0; rest == Rest::kAbove; ++round) {
    const auto more = blockKrylov(matrix, found.vectors, bound, round);
    if (!more || (round > 0 && more->values.size() == 0)) return std::nullopt;
    append(found, *more);
    rest = restOfSpectrum(matrix, found.vectors, bound);
  }
  if (rest == Rest::kUndecided || !isOrthonormal(found.vectors)) return std::nullopt;
  const VectorXd r = residuals(multiply(matrix, found.vectors), found);
  if (!(r.array() <= kResidual).all() || !((found.values - r).array() > bound).all()) return std::nullopt;
  return descending(found);
}

Eigenpairs eigenpairsAbove(const Eigen::SparseMatrix<double>& matrix, double bound) {
  if (matrix.rows() > kDenseSize) {
    if (auto pairs = krylovEigenpairsAbove(matrix, bound)) return *std::move(pairs);
  }
  return denseEigenpairsAbove(MatrixXd(matrix), bound);
}

}  // namespace shoal::matching
