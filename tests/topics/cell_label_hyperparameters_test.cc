// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/cell_label_hyperparameters.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>

namespace shoal::topics {
namespace {

template <typename T>
std::string complaint(T CellLabelHyperparameters::*field, T value) {
  CellLabelHyperparameters h;
  h.*field = value;
  try {
    check(h);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(CellLabelHyperparametersTest, AcceptTheDefaultsAndTheEndsOfEveryRange) {
  EXPECT_NO_THROW(check(CellLabelHyperparameters{}));
  EXPECT_NO_THROW(check(CellLabelHyperparameters{.max_topics = 1,
                                                 .cells_per_topic = 1,
                                                 .evidence = 1e-3,
                                                 .beta = 1.0 / 256,
                                                 .coupling = 0,
                                                 .tau = 1e-3,
                                                 .local_rate = 0,
                                                 .visits_per_cell = 0}));
  EXPECT_NO_THROW(check(CellLabelHyperparameters{.max_topics = 10'000,
                                                 .cells_per_topic = 1'000'000,
                                                 .evidence = 1e6,
                                                 .beta = 1e4,
                                                 .coupling = 100,
                                                 .tau = 1e3,
                                                 .local_rate = 1,
                                                 .visits_per_cell = 1e6}));
}

TEST(CellLabelHyperparametersTest, RejectionsNameTheFieldTheValueAndTheRange) {
  EXPECT_EQ(complaint(&CellLabelHyperparameters::coupling, -1.0), "coupling must lie in [0, 100], got -1");
}

TEST(CellLabelHyperparametersTest, RejectWhatLiesOutsideARange) {
  using H = CellLabelHyperparameters;
  EXPECT_NE(complaint(&H::max_topics, 0), "");
  EXPECT_NE(complaint(&H::max_topics, 10'001), "");
  EXPECT_NE(complaint(&H::cells_per_topic, 0), "");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  for (const auto field :
       {&H::evidence, &H::beta, &H::coupling, &H::tau, &H::local_rate, &H::visits_per_cell}) {
    for (const double bad : {-1e-6, infinite, nan}) EXPECT_NE(complaint(field, bad), "") << bad;
  }
  EXPECT_NE(complaint(&H::evidence, 0.0), "");
  EXPECT_NE(complaint(&H::beta, 0.0), "");
}

}  // namespace
}  // namespace shoal::topics
