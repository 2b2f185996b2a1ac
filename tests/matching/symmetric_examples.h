// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "shoal/random.h"

namespace shoal::matching {

/// The tridiagonal matrix with these two diagonals.
inline Eigen::MatrixXd dense(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& off_diagonal) {
  Eigen::MatrixXd t = diagonal.asDiagonal();
  for (Eigen::Index k = 0; k < off_diagonal.size(); ++k) t(k, k + 1) = t(k + 1, k) = off_diagonal[k];
  return t;
}

/// Symmetric matrices of several sizes with eigenvalues in [-1, 1], random ones and such with eigenvalues
/// that occur many times.
inline std::vector<Eigen::MatrixXd> symmetricExamples() {
  std::vector<Eigen::MatrixXd> all;
  for (const Eigen::Index size : {1, 2, 3, 5, 16, 65, 130}) {
    Random random(7);
    Eigen::MatrixXd a(size, size);
    for (double& x : a.reshaped()) x = random.uniform() - 0.5;
    all.push_back((a + a.transpose()) / static_cast<double>(size));
  }
  all.push_back(Eigen::MatrixXd::Zero(6, 6));
  all.push_back(Eigen::MatrixXd::Identity(6, 6));
  all.push_back(Eigen::MatrixXd::Constant(9, 9, 1.0 / 9.0));
  Eigen::MatrixXd cliques = Eigen::MatrixXd::Zero(12, 12);  // three of four
  for (Eigen::Index k = 0; k < 12; k += 4) cliques.block(k, k, 4, 4).setConstant(.25);
  all.push_back(cliques);
  return all;
}

}  // namespace shoal::matching
