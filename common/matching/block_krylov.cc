// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/block_krylov.h"

#include <algorithm>
#include <utility>

#include "shoal/matching/tile_product.h"
#include "shoal/random.h"

namespace shoal::matching {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kConverged = 1e-12;  // residual of a pair
constexpr double kNothing = 1e-13;    // what is left of a vector when nothing is left but round-off
constexpr double kNear = 0.05;        // how far below the bound a Ritz value is still watched
constexpr int kMaxRestarts = 40;

class KrylovSpace {
 public:
  KrylovSpace(const Eigen::SparseMatrix<double>& matrix, const MatrixXd& found, uint64_t stream)
      : matrix_(matrix), found_(found), basis_(matrix.rows(), 160), product_(160, 160) {
    Random random(0xb10c, stream);
    MatrixXd start(matrix.rows(), std::min<Index>(kTileWidth, matrix.rows() - found.cols()));
    for (double& x : start.reshaped()) x = random.uniform() - 0.5;
    append(std::move(start));
  }

  Index size() const { return size_; }
  bool isInvariant() const { return newest_ == 0; }

  // Takes the newest vectors through the matrix and appends what that adds to the space.
  void grow() {
    const Index first = size_ - newest_;
    MatrixXd image = multiply(matrix_, basis_.middleCols(first, newest_));
    // All of it that lies in the basis lies, but for round-off, in what these vectors are coupled with.
    const auto near = basis_.middleCols(coupled_, size_ - coupled_);
    const MatrixXd along = near.transpose() * image;
    image.noalias() -= near * along;
    product_.middleCols(first, newest_).topRows(coupled_).setZero();
    product_.middleRows(first, newest_).leftCols(coupled_).setZero();
    product_.block(coupled_, first, size_ - coupled_, newest_) = along;
    product_.block(first, coupled_, newest_, size_ - coupled_) = along.transpose();
    coupled_ = first;
    append(std::move(image));
  }

  // The matrix on the space, without its newest vectors, whose images are not known yet.
  MatrixXd projected() const {
    const Index known = size_ - newest_;
    const MatrixXd p = product_.topLeftCorner(known, known);
    return 0.5 * (p + p.transpose());
  }

  // The residuals of Ritz vectors given in terms of the basis, without its newest vectors.
  Eigen::VectorXd residuals(const MatrixXd& ritz) const {
    return (coupling_ * ritz.bottomRows(coupling_.cols())).colwise().norm().transpose();
  }

  MatrixXd vectors(const MatrixXd& ritz) const { return basis_.leftCols(ritz.rows()) * ritz; }

  // Keeps these Ritz pairs and the newest vectors.
  void restart(const Eigenpairs& ritz) {
    const Index kept = ritz.values.size();
    const MatrixXd newest = basis_.middleCols(size_ - newest_, newest_);
    basis_.leftCols(kept) = vectors(ritz.vectors);
    basis_.middleCols(kept, newest_) = newest;
    product_.topLeftCorner(kept, kept) = ritz.values.asDiagonal();
    size_ = kept + newest_;
    coupled_ = 0;
  }

 private:
  void project(MatrixXd& x) const {
    x.noalias() -= basis_.leftCols(size_) * (basis_.leftCols(size_).transpose() * x).eval();
    if (found_.cols() > 0) x.noalias() -= found_ * (found_.transpose() * x).eval();
  }

  // Gram-Schmidt among the columns of x: returns x = Q R and leaves Q, as many columns as have length.
  static MatrixXd orthonormalize(MatrixXd& x, double& shortest) {
    MatrixXd r = MatrixXd::Zero(x.cols(), x.cols());
    Index kept = 0;
    shortest = 1.0;
    for (Index c = 0; c < x.cols(); ++c) {
      Eigen::VectorXd column = x.col(c);
      for (int twice = 0; twice < 2; ++twice) {
        const Eigen::VectorXd along = x.leftCols(kept).transpose() * column;
        column.noalias() -= x.leftCols(kept) * along;
        r.col(c).head(kept) += along;
      }
      const double length = column.norm();
      if (length <= kNothing) continue;
      shortest = std::min(shortest, length);
      r(kept, c) = length;
      x.col(kept++) = column / length;
    }
    x.conservativeResize(Eigen::NoChange, kept);
    return r.topRows(kept);
  }

  // Appends what the columns of x add to the basis, as its newest vectors.
  void append(MatrixXd x) {
    double shortest = 0.0;
    coupling_ = orthonormalize(x, shortest);
    // Making a short vector long makes its round-off long: project until nothing is short.
    for (int again = 0; again < 4 && x.cols() > 0; ++again) {
      project(x);
      coupling_ = (orthonormalize(x, shortest) * coupling_).eval();
      if (shortest > 0.5) break;
    }
    newest_ = x.cols();
    if (size_ + newest_ > basis_.cols()) {
      basis_.conservativeResize(Eigen::NoChange, 2 * basis_.cols());
      product_.conservativeResize(basis_.cols(), basis_.cols());
    }
    basis_.middleCols(size_, newest_) = x;
    size_ += newest_;
  }

  const Eigen::SparseMatrix<double>& matrix_;
  const MatrixXd& found_;
  MatrixXd basis_;     // s×size_ in use, orthonormal; the last newest_ are not multiplied yet
  MatrixXd product_;   // basis' matrix basis, but for the newest
  MatrixXd coupling_;  // the newest vectors times this are what the last product added to the space
  Index size_ = 0;
  Index newest_ = 0;
  Index coupled_ = 0;  // basis vectors from here on are coupled with the newest
};

bool done(const Eigenpairs& ritz, const Eigen::VectorXd& residuals, double bound) {
  for (Index k = 0; k < ritz.values.size(); ++k) {
    const double room = ritz.values[k] > bound ? 0.0 : bound - ritz.values[k];
    if (residuals[k] > std::max(kConverged, room)) return false;
  }
  return true;
}

}  // namespace

std::optional<Eigenpairs> blockKrylov(const Eigen::SparseMatrix<double>& matrix, const MatrixXd& found,
                                      double bound, uint64_t stream) {
  KrylovSpace space(matrix, found, stream);
  Index next_look = 5 * kTileWidth;
  for (int restarts = 0; restarts <= kMaxRestarts;) {
    space.grow();
    const bool is_invariant = space.isInvariant();
    if (space.size() < next_look && !is_invariant) continue;
    next_look = space.size() + std::max<Index>(2 * kTileWidth, space.size() / 5);

    const MatrixXd projected = space.projected();
    const Eigenpairs ritz = denseEigenpairsAbove(projected, bound - kNear);
    const Index above = (ritz.values.array() > bound).count();
    if (found.cols() + above > matrix.rows() / 3) return std::nullopt;
    if (is_invariant || done(ritz, space.residuals(ritz.vectors), bound)) {
      return Eigenpairs{ritz.values.head(above), space.vectors(ritz.vectors.leftCols(above))};
    }
    if (space.size() > std::max<Index>(160, 4 * above + 80)) {
      Eigenpairs all = denseEigenpairsAbove(projected, -2.0);
      const Index kept = std::min<Index>(above + 3 * kTileWidth, all.values.size());
      space.restart({all.values.head(kept), all.vectors.leftCols(kept)});
      ++restarts;
      next_look = space.size() + 2 * kTileWidth;
    }
  }
  return std::nullopt;
}

}  // namespace shoal::matching
