// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/tridiagonal_spectrum.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "shoal/demand.h"
#include "shoal/random.h"

namespace shoal::matching {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kLanes = 8;
using Lanes = std::array<double, kLanes>;

typedef double Two __attribute__((vector_size(16)));
typedef int64_t TwoCounts __attribute__((vector_size(16)));

// Sturm's count of two bounds at once: the negative pivots of bound I - T. A pivot of 0 stands for a positive
// one, so the next is -infinity, and the arithmetic goes on.
struct SturmCount {
  Two bound = {};
  Two pivot = {};
  TwoCounts negative = {};

  void step(double diagonal, double coupling) {
    pivot = coupling == 0.0 ? bound - diagonal : bound - diagonal - coupling / pivot;
    negative -= pivot < 0.0;  // -1 where it is
  }
};

// The same for eight: four chains of divisions that do not wait for each other.
std::array<int, kLanes> countAboveEach(const VectorXd& diagonal, const VectorXd& off_diagonal,
                                       const Lanes& bounds) {
  SturmCount a{.bound = {bounds[0], bounds[1]}};
  SturmCount b{.bound = {bounds[2], bounds[3]}};
  SturmCount c{.bound = {bounds[4], bounds[5]}};
  SturmCount d{.bound = {bounds[6], bounds[7]}};
  const double* const entry = diagonal.data();
  const double* const off = off_diagonal.data();
  for (Index i = 0; i < diagonal.size(); ++i) {
    const double coupling = i == 0 ? 0.0 : off[i - 1] * off[i - 1];
    a.step(entry[i], coupling);
    b.step(entry[i], coupling);
    c.step(entry[i], coupling);
    d.step(entry[i], coupling);
  }
  std::array<int, kLanes> count{};
  size_t lane = 0;
  for (const SturmCount& two : {a, b, c, d}) {
    for (const int k : {0, 1}) count[lane++] = static_cast<int>(two.negative[k]);
  }
  return count;
}

// T - shift I = P L U by Gaussian elimination with partial pivoting: U has two bands above its diagonal.
class ShiftedSolver {
 public:
  ShiftedSolver(const VectorXd& diagonal, const VectorXd& off_diagonal, double shift)
      : rows_(static_cast<size_t>(diagonal.size())) {
    const Index size = diagonal.size();
    double pivot = diagonal[0] - shift;
    double above = size > 1 ? off_diagonal[0] : 0.0;
    for (Index k = 0; k + 1 < size; ++k) {
      Row& row = rows_[static_cast<size_t>(k)];
      const double below = off_diagonal[k];
      const double next = diagonal[k + 1] - shift;
      const double after = k + 2 < size ? off_diagonal[k + 1] : 0.0;
      row.swapped = std::abs(below) > std::abs(pivot);
      if (row.swapped) {
        row.factor = pivot / below;
        row.inverse = 1.0 / below;
        row.first = next;
        row.second = after;
        pivot = above - row.factor * next;
        above = -row.factor * after;
      } else {
        pivot = awayFromZero(pivot);
        row.inverse = 1.0 / pivot;
        row.factor = below * row.inverse;
        row.first = above;
        row.second = 0.0;
        pivot = next - row.factor * above;
        above = after;
      }
    }
    rows_.back().inverse = 1.0 / awayFromZero(pivot);
  }

  template <class Vector>
  void solve(Vector x) const {
    const auto size = static_cast<Index>(rows_.size());
    for (Index k = 0; k + 1 < size; ++k) {
      const Row& row = rows_[static_cast<size_t>(k)];
      if (row.swapped) std::swap(x[k], x[k + 1]);
      x[k + 1] -= row.factor * x[k];
    }
    for (Index k = size - 1; k >= 0; --k) {
      const Row& row = rows_[static_cast<size_t>(k)];
      double value = x[k];
      if (k + 1 < size) value -= row.first * x[k + 1];
      if (k + 2 < size) value -= row.second * x[k + 2];
      x[k] = value * row.inverse;
    }
  }

 private:
  struct Row {
    double factor = 0.0;   // of L
    double inverse = 0.0;  // 1 / the diagonal of U
    double first = 0.0;    // the bands above it
    double second = 0.0;
    bool swapped = false;
  };

  // A pivot of 0 is what an exact eigenvalue leaves: round-off of T stands in for it.
  static double awayFromZero(double pivot) {
    constexpr double kLeast = std::numeric_limits<double>::epsilon();
    return std::abs(pivot) < kLeast ? std::copysign(kLeast, pivot) : pivot;
  }

  std::vector<Row> rows_;
};

}  // namespace

int countAbove(const VectorXd& diagonal, const VectorXd& off_diagonal, double bound) {
  Lanes bounds;
  bounds.fill(bound);
  return countAboveEach(diagonal, off_diagonal, bounds)[0];
}

VectorXd greatestEigenvalues(const VectorXd& diagonal, const VectorXd& off_diagonal, int count) {
  const Index size = diagonal.size();
  SHOAL_DEMAND(count <= size);
  double radius = 0.0;  // Gershgorin: no eigenvalue lies outside [-radius, radius]
  for (Index i = 0; i < size; ++i) {
    const double left = i > 0 ? std::abs(off_diagonal[i - 1]) : 0.0;
    const double right = i + 1 < size ? std::abs(off_diagonal[i]) : 0.0;
    radius = std::max(radius, std::abs(diagonal[i]) + left + right);
  }
  constexpr int kHalvings = 50;
  VectorXd values(count);
  for (int first = 0; first < count; first += kLanes) {
    Lanes low;
    Lanes high;
    low.fill(-radius);
    high.fill(radius);
    for (int halving = 0; halving < kHalvings; ++halving) {
      Lanes middle;
      for (size_t k = 0; k < kLanes; ++k) middle[k] = 0.5 * (low[k] + high[k]);
      const std::array<int, kLanes> above = countAboveEach(diagonal, off_diagonal, middle);
      for (size_t k = 0; k < kLanes; ++k) {
        (above[k] > first + static_cast<int>(k) ? low : high)[k] = middle[k];
      }
    }
    for (int k = 0; k < kLanes && first + k < count; ++k) {
      values[first + k] = 0.5 * (low[static_cast<size_t>(k)] + high[static_cast<size_t>(k)]);
    }
  }
  return values;
}

Eigen::MatrixXd inverseIteration(const VectorXd& diagonal, const VectorXd& off_diagonal,
                                 const VectorXd& values) {
  constexpr double kClose = 1e-2;
  constexpr int kSteps = 3;
  const Index size = diagonal.size();
  Eigen::MatrixXd vectors(size, values.size());
  for (Index c = 0; c < values.size(); ++c) {
    Index first = c;  // of the eigenvalues close to this one
    while (first > 0 && values[first - 1] - values[c] < kClose) --first;
    const ShiftedSolver solver(diagonal, off_diagonal, values[c]);
    Random random(0x1417, static_cast<uint64_t>(c));
    auto x = vectors.col(c);
    for (double& entry : x) entry = random.uniform() - 0.5;
    for (int step = 0; step < kSteps; ++step) {
      solver.solve(x);
      x.normalize();
      for (Index other = first; other < c; ++other) x -= vectors.col(other).dot(x) * vectors.col(other);
      x.normalize();
    }
  }
  return vectors;
}

}  // namespace shoal::matching
