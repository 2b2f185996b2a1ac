// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/hyperparameters.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>

namespace shoal::topics {
namespace {

// What check() says against one changed field; empty if nothing.
template <typename T>
std::string complaint(T Hyperparameters::*field, T value) {
  Hyperparameters h;
  h.*field = value;
  try {
    check(h);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(HyperparametersTest, AcceptTheDefaultsAndThePublishedOnes) {
  EXPECT_NO_THROW(check({}));
  EXPECT_NO_THROW(check({.max_topics = 32, .alpha = 0.008587, .beta = 4.69229, .gamma = 1.5e-5}));
}

TEST(HyperparametersTest, AcceptTheEndsOfEveryRange) {
  EXPECT_NO_THROW(check({.max_topics = 1,
                         .alpha = 1e-9,
                         .beta = 1e-9,
                         .gamma = 1e-30,
                         .neighbor_weight = 0,
                         .tau = 1e-3,
                         .local_rate = 0,
                         .resamples_per_observation = 0}));
  EXPECT_NO_THROW(check({.max_topics = 10000,
                         .alpha = 1e6,
                         .beta = 1e6,
                         .gamma = 1e6,
                         .neighbor_weight = 1,
                         .tau = 1e3,
                         .local_rate = 1}));
}

TEST(HyperparametersTest, RejectionsNameTheFieldTheValueAndTheRange) {
  EXPECT_EQ(complaint(&Hyperparameters::neighbor_weight, 1.5), "neighbor_weight must lie in [0, 1], got 1.5");
}

TEST(HyperparametersTest, RejectWhatLiesOutsideARange) {
  EXPECT_NE(complaint(&Hyperparameters::max_topics, 0), "");
  EXPECT_NE(complaint(&Hyperparameters::max_topics, 10001), "");
  EXPECT_NE(complaint(&Hyperparameters::resamples_per_observation, int64_t{-1}), "");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  for (const auto field :
       {&Hyperparameters::alpha, &Hyperparameters::beta, &Hyperparameters::gamma,
        &Hyperparameters::neighbor_weight, &Hyperparameters::tau, &Hyperparameters::local_rate}) {
    for (const double bad : {-1e-6, infinite, nan}) EXPECT_NE(complaint(field, bad), "") << bad;
  }
  EXPECT_NE(complaint(&Hyperparameters::alpha, 0.0), "");
  EXPECT_NE(complaint(&Hyperparameters::beta, 0.0), "");
  EXPECT_NE(complaint(&Hyperparameters::tau, 0.0), "");
}

}  // namespace
}  // namespace shoal::topics
