// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/spectrum.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <vector>

#include "noisy_graph.h"
#include "shoal/matching/clear.h"

namespace shoal::matching {
namespace {

Eigen::VectorXd allEigenvalues(const Eigen::SparseMatrix<double>& laplacian) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(Eigen::MatrixXd(laplacian)).eigenvalues();
}

std::vector<double> keptEigenvalues(const SmallEnd& end) {
  std::vector<double> values;
  for (const ComponentSpectrum& c : end.components) {
    values.insert(values.end(), c.eigenvalues.begin(), c.eigenvalues.end());
  }
  std::sort(values.begin(), values.end());
  return values;
}

TEST(ConnectedComponentsTest, AreFoundByTheirLowestVertex) {
  //   0 - 3   1   2 - 4 - 5
  const auto laplacian = normalizedLaplacian({{1, 1, 1, 1, 1, 1}, {{0, 3}, {2, 4}, {4, 5}}});
  EXPECT_EQ(connectedComponents(laplacian), (std::vector<std::vector<int>>{{0, 3}, {1}, {2, 4, 5}}));
}

TEST(ConnectedComponentsTest, AreNotJoinedByAnEdgeOfWeightZero) {
  EXPECT_EQ(connectedComponents(normalizedLaplacian({{1, 1}, {{0, 1, 0.0}}})).size(), 2u);
}

// Path of three: 0, 1/2, 7/6. A clique of three: 0, 1, 1. A single vertex: 0. An edge of weight w: 0, 2w / (1
// + w).
TEST(SmallEndTest, HasTheEigenvaluesWorkedByHand) {
  const auto path = normalizedLaplacian({{1, 1, 1}, {{0, 1}, {1, 2}}});
  EXPECT_EQ(smallEnd(path, .5 - 1e-6, 0).num_below, 1);
  EXPECT_EQ(smallEnd(path, .5 + 1e-6, 0).num_below, 2);
  const auto clique_and_one = normalizedLaplacian({{1, 1, 1, 1}, {{0, 1}, {0, 2}, {1, 2}}});
  EXPECT_EQ(smallEnd(clique_and_one, .999, 0).num_below, 2);
  EXPECT_EQ(smallEnd(clique_and_one, 1.001, 0).num_below, 4);
  EXPECT_EQ(smallEnd(normalizedLaplacian({{1, 1}, {{0, 1, .3}}}), .5, 0).num_below, 2);
  const SmallEnd pair = smallEnd(normalizedLaplacian({{1, 1}, {{0, 1, .3}}}), .5, 0);
  EXPECT_NEAR(pair.components[0].eigenvalues[1], .6 / 1.3, 1e-12);
}

// Random graphs of many components: the union of the spectra of the components is the spectrum of the graph.
TEST(SmallEndTest, IsTheSmallEndOfTheWholeSpectrum) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const auto graph =
        makeNoisyGraph(3 + static_cast<int>(seed % 5), 6, .4, seed % 3 == 0 ? .3 : .02, seed).graph;
    const auto laplacian = normalizedLaplacian(graph);
    const Eigen::VectorXd all = allEigenvalues(laplacian);
    const auto below = static_cast<int>((all.array() < .5 - 1e-6).count());
    for (const int at_least : {0, below + 3, graph.numVertices()}) {
      const SmallEnd end = smallEnd(laplacian, .5 - 1e-6, at_least);
      EXPECT_EQ(end.num_below, below);
      const std::vector<double> kept = keptEigenvalues(end);
      ASSERT_EQ(kept.size(), static_cast<size_t>(std::max(below, at_least)));
      ASSERT_EQ(end.num_kept, static_cast<int>(kept.size()));
      for (size_t k = 0; k < kept.size(); ++k) EXPECT_NEAR(kept[k], all[static_cast<Eigen::Index>(k)], 1e-9);
      for (const ComponentSpectrum& c : end.components) {
        const Eigen::MatrixXd gram = c.eigenvectors.transpose() * c.eigenvectors;
        EXPECT_TRUE(gram.isIdentity(1e-9));
        for (Eigen::Index k = 0; k < c.eigenvalues.size(); ++k) {
          Eigen::VectorXd vector = Eigen::VectorXd::Zero(laplacian.rows());
          vector(c.vertices) = c.eigenvectors.col(k);
          EXPECT_LE((laplacian * vector - c.eigenvalues[k] * vector).norm(), 1e-9);
        }
      }
    }
  }
}

// Four robots with three topics each, all pairs joined: the eigenvalue after 0 occurs many times, and two of
// its vectors are kept. Gram-Schmidt on the lowest vertices: the first lies along the projection of vertex 0,
// and vertex 0 has no part in the second.
TEST(SmallEndTest, CutsAnEigenspaceByItsLowestVertices) {
  AssociationGraph graph{{3, 3, 3, 3}, {}};
  for (int i = 0; i < 12; ++i) {
    for (int j = i + 1; j < 12; ++j) {
      if (i / 3 != j / 3) graph.edges.push_back({i, j});
    }
  }
  const SmallEnd end = smallEnd(normalizedLaplacian(graph), .5, 3);
  ASSERT_EQ(end.components.size(), 1u);
  const ComponentSpectrum& c = end.components[0];
  ASSERT_EQ(c.eigenvalues.size(), 3);
  EXPECT_NEAR(c.eigenvalues[1], c.eigenvalues[2], 1e-9);
  EXPECT_GT(c.eigenvectors(0, 1), .5);
  EXPECT_NEAR(c.eigenvectors(0, 2), 0.0, 1e-9);
  EXPECT_GT(c.eigenvectors(1, 2), .5);
}

}  // namespace
}  // namespace shoal::matching
