// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/count_certificate.h"

#include <algorithm>
#include <cmath>

#include "shoal/demand.h"
#include "shoal/matching/tile_product.h"
#include "shoal/random.h"

namespace shoal::matching {
namespace {

using Eight = Eigen::Array<double, 1, kTileWidth>;

constexpr double kChance = 1e-12;

void project(const Eigen::MatrixXd& found, Tile& x) {
  if (found.cols() > 0) x.noalias() -= found * (found.transpose() * x).eval();
}

// 1 / |x|, or 0 for what is nothing but round-off.
Eight inverse(const Eight& length) { return (length > 1e-13).select(1.0 / length, 0.0); }

}  // namespace

Rest restOfSpectrum(const Eigen::SparseMatrix<double>& matrix, const Eigen::MatrixXd& found, double bound,
                    int steps) {
  SHOAL_DEMAND(bound > 0.0 && bound <= 1.0);
  const Eigen::Index size = matrix.rows();
  Random random(0xba11, static_cast<uint64_t>(size), static_cast<uint64_t>(found.cols()));
  Tile q(size, kTileWidth);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (double& x : q.row(i)) x = random.uniform() - 0.5;
  }
  project(found, q);
  project(found, q);
  const Eight start = q.colwise().norm().array();
  q.array().rowwise() *= inverse(start);

  Tile before = Tile::Zero(size, kTileWidth);
  Tile next(size, kTileWidth);
  Eight beta = Eight::Zero();
  Eight p_before = Eight::Zero();
  Eight p = Eight::Ones();
  Eight greatest = Eight::Ones();  // of the p so far
  for (int step = 0; step < steps; ++step) {
    multiply(matrix, q, next);
    const Eight alpha = q.cwiseProduct(next).colwise().sum().array();
    next.array() -= q.array().rowwise() * alpha + before.array().rowwise() * beta;
    project(found, next);
    const Eight length = next.colwise().norm().array();
    const Eight grown = (bound - alpha) * p - beta * p_before;  // p_{k+1} times its β
    if ((grown <= 0.0).any()) return Rest::kAbove;

    // A recurrence that has come to its end spans an invariant space: it excludes all beyond it.
    const Eight p_next = grown / length.max(1e-13);
    greatest = greatest.max(p_next);
    double chance = 1.0;
    for (int k = 0; k < kTileWidth; ++k) {
      chance *= std::min(1.0, 2.0 * std::sqrt(2.0) * start[k] / greatest[k]);
    }
    if (chance <= kChance) return Rest::kBelow;

    p_before = p;
    p = p_next;
    beta = length;
    before.swap(q);
    q = (next.array().rowwise() * inverse(length)).matrix();
  }
  return Rest::kUndecided;
}

}  // namespace shoal::matching
