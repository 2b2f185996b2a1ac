// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/tile_product.h"

#include <gtest/gtest.h>

#include "graph_matrices.h"
#include "noisy_graph.h"
#include "shoal/random.h"

namespace shoal::matching {
namespace {

TEST(TileProductTest, IsTheProductForAnyNumberOfVectors) {
  const auto matrix = complement(makeNoisyGraph(6, 5, .2, .2, 1).graph);
  Random random(5);
  for (const Eigen::Index count : {0, 1, 7, 8, 9, 20}) {
    Eigen::MatrixXd x(matrix.rows(), count);
    for (double& entry : x.reshaped()) entry = random.uniform();
    const Eigen::MatrixXd expected = Eigen::MatrixXd(matrix) * x;
    EXPECT_TRUE(multiply(matrix, x).isApprox(expected, 1e-14) || count == 0) << count;
    EXPECT_EQ(multiply(matrix, x).cols(), count);
  }
}

}  // namespace
}  // namespace shoal::matching
