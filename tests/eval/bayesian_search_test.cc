// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/bayesian_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "shoal/random.h"

namespace shoal::eval {
namespace {

const std::vector<Knob> kKnobs{{"alpha", 1e-3, 10.0}, {"beta", 1e-2, 1.0}};

// A hill over the logarithms with its top at alpha .1, beta .2, and a little noise.
double hill(const std::vector<double>& values, Random& noise) {
  const double a = std::log10(values[0]) + 1, b = std::log10(values[1] / 0.2);
  return std::exp(-(a * a + b * b)) + 0.02 * (noise.uniform() - 0.5);
}

TEST(BayesianSearchTest, ClimbsAHillFasterThanChance) {
  int better = 0;
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    Random noise(seed);
    std::vector<Tried> guided, by_chance;
    for (int i = 0; i < 30; ++i) {
      std::vector<double> values = nextSetting(kKnobs, guided, 10, seed);
      guided.push_back({values, hill(values, noise)});
      values = nextSetting(kKnobs, by_chance, 1000, seed);
      by_chance.push_back({values, hill(values, noise)});
    }
    Random silent(0);
    const auto height = [&](const std::vector<Tried>& tried) {
      return hill(tried[bestSetting(kKnobs, tried)].values, silent);
    };
    EXPECT_GT(height(guided), 0.95) << "seed " << seed;
    better += height(guided) >= height(by_chance) - 0.01;
  }
  EXPECT_GE(better, 4);
}

TEST(BayesianSearchTest, RandomSettingsCoverTheSpace) {
  std::vector<Tried> tried;
  for (int i = 0; i < 16; ++i) tried.push_back({nextSetting(kKnobs, tried, 16, 3), 0});
  int quarters[4] = {};
  for (const Tried& t : tried) {
    EXPECT_GE(t.values[0], 1e-3);
    EXPECT_LE(t.values[0], 10.0);
    ++quarters[(t.values[0] > 0.1 ? 2 : 0) + (t.values[1] > 0.1 ? 1 : 0)];
  }
  for (const int n : quarters) EXPECT_GE(n, 2);
}

TEST(BayesianSearchTest, ALuckyRunDoesNotWin) {
  std::vector<Tried> tried;
  Random noise(1);
  for (int i = 0; i < 40; ++i) {
    const std::vector<double> values = nextSetting(kKnobs, tried, 40, 1);
    tried.push_back({values, hill(values, noise)});
  }
  const auto worst = std::ranges::min_element(tried, {}, &Tried::score);
  worst->score = 0.9;  // far from the top, among bad neighbours
  EXPECT_NE(bestSetting(kKnobs, tried), static_cast<size_t>(worst - tried.begin()));
}

TEST(BayesianSearchTest, IsAFunctionOfItsArgumentsAndRefusesNonsense) {
  EXPECT_EQ(nextSetting(kKnobs, {}, 5, 1), nextSetting(kKnobs, {}, 5, 1));
  EXPECT_NE(nextSetting(kKnobs, {}, 5, 1), nextSetting(kKnobs, {}, 5, 2));
  EXPECT_THROW(nextSetting({}, {}, 5, 1), std::invalid_argument);
  EXPECT_THROW(nextSetting({{"alpha", 1.0, 1.0}}, {}, 5, 1), std::invalid_argument);
  EXPECT_THROW(bestSetting(kKnobs, {}), std::invalid_argument);
}

}  // namespace
}  // namespace shoal::eval
