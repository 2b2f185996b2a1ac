// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/eigenpairs.h"

#include <Spectra/SymEigsSolver.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "shoal/demand.h"
#include "shoal/random.h"

namespace shoal::matching {
namespace {

constexpr double kResidual = 1e-9;
constexpr double kShift = 1.0;

// B + I - V (Θ + I) V': eigenvalues are 1 greater, but what has been found already, (Θ, V), moves to 0.
// Without the shift a matrix of low rank leaves Spectra's tridiagonal solver nothing but round-off, on which
// it does not end.
class Deflated {
 public:
  using Scalar = double;

  explicit Deflated(const Eigen::SparseMatrix<double>& matrix) : matrix_(matrix) {}

  Eigen::Index rows() const { return matrix_.rows(); }
  Eigen::Index cols() const { return matrix_.cols(); }

  void perform_op(const double* x_in, double* y_out) const {
    const Eigen::Map<const Eigen::VectorXd> x(x_in, rows());
    Eigen::Map<Eigen::VectorXd> y(y_out, rows());
    y.noalias() = matrix_.selfadjointView<Eigen::Lower>() * x;
    y += kShift * x;
    if (found_.values.size() == 0) return;
    const Eigen::VectorXd along = found_.vectors.transpose() * x;
    y.noalias() -= found_.vectors * (found_.values.array() + kShift).matrix().cwiseProduct(along);
  }

  void deflate(const Eigenpairs& more) {
    const Eigen::Index old = found_.values.size();
    found_.values.conservativeResize(old + more.values.size());
    found_.values.tail(more.values.size()) = more.values;
    found_.vectors.conservativeResize(rows(), old + more.values.size());
    found_.vectors.rightCols(more.values.size()) = more.vectors;
  }

  const Eigenpairs& found() const { return found_; }

 private:
  const Eigen::SparseMatrix<double>& matrix_;
  Eigenpairs found_;
};

// Spectra's solver, which also tells all Ritz values of its subspace, converged or not.
class Lanczos : public Spectra::SymEigsSolver<Deflated> {
 public:
  Lanczos(Deflated& op, int wanted, int subspace, uint64_t stream)
      : SymEigsSolver(op, std::min<Eigen::Index>(wanted, op.rows() - 1),
                      std::min<Eigen::Index>(std::max(subspace, wanted + 2), op.rows())) {
    Random random(0xc1ea5, stream);
    Eigen::VectorXd start(op.rows());
    for (double& x : start) x = random.uniform() - 0.5;
    init(start.data());
  }

  // Restarts until the wanted pairs are as exact as `tolerance`, at most `restarts` times.
  bool run(int restarts, double tolerance) {
    compute(Spectra::SortRule::LargestAlge, restarts, tolerance, Spectra::SortRule::LargestAlge);
    return info() == Spectra::CompInfo::Successful;
  }

  // By Cauchy's interlacing never more than there are eigenvalues.
  int numRitzValuesAbove(double bound) const {
    return static_cast<int>((ritz_.array() - kShift > bound).count());
  }

  // The wanted pairs of B, after a successful run().
  Eigenpairs pairs() const { return {eigenvalues().array() - kShift, eigenvectors()}; }

 private:
  void sort_ritzpair(Spectra::SortRule rule) override {
    ritz_ = m_ritz_val;
    SymEigsSolver::sort_ritzpair(rule);
  }

  Eigen::VectorXd ritz_;
};

// Is nothing above `bound` left? Decides roughly where it can and exactly where it must.
bool nothingAbove(Deflated& rest, double bound, uint64_t stream, bool& decided) {
  for (const double tolerance : {1e-3, 1e-11}) {
    Lanczos top(rest, 1, 40, stream);
    decided = top.run(300, tolerance);
    if (!decided) return false;
    const double value = top.pairs().values[0];
    if (value > bound) return false;
    if (value + tolerance * (value + kShift) <= bound) return true;
  }
  return true;
}

bool certified(const Eigen::SparseMatrix<double>& matrix, const Eigenpairs& pairs, double bound) {
  for (Eigen::Index c = 0; c < pairs.values.size(); ++c) {
    const Eigen::VectorXd v = pairs.vectors.col(c);
    const double residual = (matrix.selfadjointView<Eigen::Lower>() * v - pairs.values[c] * v).norm();
    if (!(residual <= kResidual) || !(pairs.values[c] - residual > bound)) return false;
  }
  return true;
}

Eigenpairs descending(const Eigenpairs& pairs) {
  std::vector<Eigen::Index> order(static_cast<size_t>(pairs.values.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](auto a, auto b) { return pairs.values[a] > pairs.values[b]; });
  return {pairs.values(order), pairs.vectors(Eigen::all, order)};
}

std::optional<Eigenpairs> deflateUntilNothingIsAbove(const Eigen::SparseMatrix<double>& matrix,
                                                     double bound) {
  const int size = static_cast<int>(matrix.rows());
  Deflated rest(matrix);
  for (uint64_t round = 0; size >= 8; ++round) {
    Lanczos probe(rest, 1, 80, 2 * round);
    probe.run(0, 1e-3);
    int left = probe.numRitzValuesAbove(bound);
    if (left == 0) {
      bool decided = false;
      if (nothingAbove(rest, bound, 2 * round, decided)) break;
      if (!decided) return std::nullopt;
      left = 1;
    }
    const Eigen::Index found = rest.found().values.size();
    if (found + left > size / 3) return std::nullopt;  // dense is cheaper
    Lanczos solver(rest, left, 2 * left + 40, 2 * round + 1);
    if (!solver.run(300, 1e-12)) return std::nullopt;
    // A start vector may have been unlucky, another may not: what is there and above counts.
    const Eigenpairs pairs = solver.pairs();
    const Eigen::Index above = (pairs.values.array() > bound).count();
    if (above == 0) return std::nullopt;
    rest.deflate({pairs.values.head(above), pairs.vectors.leftCols(above)});
  }
  if (rest.found().values.size() == 0) return std::nullopt;
  if (!certified(matrix, rest.found(), bound)) return std::nullopt;
  return descending(rest.found());
}

}  // namespace

Eigenpairs denseEigenpairsAbove(const Eigen::SparseMatrix<double>& matrix, double bound) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver{Eigen::MatrixXd(matrix)};
  SHOAL_DEMAND(solver.info() == Eigen::Success);
  const Eigen::Index count = (solver.eigenvalues().array() > bound).count();
  return {solver.eigenvalues().tail(count).reverse(),
          solver.eigenvectors().rightCols(count).rowwise().reverse()};
}

std::optional<Eigenpairs> krylovEigenpairsAbove(const Eigen::SparseMatrix<double>& matrix, double bound) {
  try {
    return deflateUntilNothingIsAbove(matrix, bound);
  } catch (const std::runtime_error&) {  // Spectra: no convergence inside its subspace
    return std::nullopt;
  }
}

Eigenpairs eigenpairsAbove(const Eigen::SparseMatrix<double>& matrix, double bound) {
  if (matrix.rows() > kDenseSize) {
    if (auto pairs = krylovEigenpairsAbove(matrix, bound)) return *std::move(pairs);
  }
  return denseEigenpairsAbove(matrix, bound);
}

}  // namespace shoal::matching
