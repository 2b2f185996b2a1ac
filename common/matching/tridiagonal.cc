// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/tridiagonal.h"

#include <cmath>
#include <limits>
#include <utility>

#include "shoal/demand.h"

namespace shoal::matching {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kTiny = std::numeric_limits<double>::min();

// A Householder reflection I - scale v v' with v[0] = 1 that takes x to (beta, 0, ..). Leaves v in x.
struct Reflection {
  double scale = 0.0;
  double beta = 0.0;
};

template <class Vector>
Reflection reflect(Vector x) {
  const double first = x[0];
  const double rest = x.tail(x.size() - 1).squaredNorm();
  x[0] = 1.0;
  if (rest <= kTiny) {
    x.tail(x.size() - 1).setZero();
    return {0.0, first};
  }
  const double beta = std::copysign(std::sqrt(first * first + rest), -first);
  x.tail(x.size() - 1) /= first - beta;
  return {(beta - first) / beta, beta};
}

// One column of the trailing matrix, from its diagonal down: subtracts what is pending, v w' + w v', and adds
// its share of the product with the vector u. Four partial sums, whatever the machine's vectors.
struct Column {
  double* entries;
  Index length;
  double v_here, w_here, u_here;

  void step(const double* v, const double* w, const double* u, double* product) const {
    using Four = Eigen::Array<double, 4, 1>;
    entries[0] -= w_here * v[0] + v_here * w[0];
    Four sums = Four::Zero();
    Index i = 1;
    for (; i + 4 <= length; i += 4) {
      const Four c = Four::Map(entries + i) - (w_here * Four::Map(v + i) + v_here * Four::Map(w + i));
      Four::Map(entries + i) = c;
      sums += c * Four::Map(u + i);
      Four::Map(product + i) += u_here * c;
    }
    double sum = entries[0] * u_here + ((sums[0] + sums[1]) + (sums[2] + sums[3]));
    for (; i < length; ++i) {
      entries[i] -= w_here * v[i] + v_here * w[i];
      sum += entries[i] * u[i];
      product[i] += u_here * entries[i];
    }
    product[0] += sum;
  }
};

}  // namespace

void Tridiagonal::lift(Eigen::MatrixXd& vectors) const {
  const Index size = diagonal.size();
  for (Index c = 0; c < vectors.cols(); ++c) {
    for (Index k = size - 2; k >= 0; --k) {
      if (scale[k] == 0.0) continue;
      const auto v = reflectors.col(k).tail(size - k - 1);
      auto x = vectors.col(c).tail(size - k - 1);
      x -= (scale[k] * v.dot(x)) * v;
    }
  }
}

Tridiagonal tridiagonalize(Eigen::MatrixXd matrix) {
  const Index size = matrix.rows();
  SHOAL_DEMAND(size >= 1 && matrix.cols() == size);
  Tridiagonal t;
  t.diagonal.resize(size);
  t.off_diagonal.resize(size - 1);
  t.scale = VectorXd::Zero(size);
  VectorXd v = VectorXd::Zero(size);  // what is still to be subtracted from the rest: v w' + w v'
  VectorXd w = VectorXd::Zero(size);
  VectorXd product(size);
  for (Index k = 0; k < size; ++k) {
    matrix.col(k).tail(size - k) -= w[k] * v.tail(size - k) + v[k] * w.tail(size - k);
    t.diagonal[k] = matrix(k, k);
    if (k + 1 == size) break;
    const Index rest = size - k - 1;
    const Reflection reflection = reflect(matrix.col(k).tail(rest));
    t.off_diagonal[k] = reflection.beta;
    t.scale[k] = reflection.scale;
    const auto next = matrix.col(k);  // the Householder vector, from row k + 1
    product.tail(rest).setZero();
    for (Index j = k + 1; j < size; ++j) {
      const Column column{&matrix(j, j), size - j, v[j], w[j], next[j]};
      column.step(&v[j], &w[j], &next[j], &product[j]);
    }
    product.tail(rest) *= reflection.scale;
    const double half = 0.5 * reflection.scale * product.tail(rest).dot(next.tail(rest));
    v.tail(rest) = next.tail(rest);
    w.tail(rest) = product.tail(rest) - half * next.tail(rest);
  }
  t.reflectors = std::move(matrix);
  return t;
}

}  // namespace shoal::matching
