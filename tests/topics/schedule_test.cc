// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/schedule.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

namespace shoal::topics {
namespace {

// Share of visits per cell over many draws.
std::vector<int64_t> histogram(const VisitLaw& law, const std::vector<int32_t>& latest, int32_t num_cells,
                               int64_t num_visits) {
  std::vector<int64_t> visits(static_cast<size_t>(num_cells));
  for (int64_t i = 0; i < num_visits; ++i) {
    Random random(11, static_cast<uint64_t>(i));
    ++visits[static_cast<size_t>(nextVisit(law, latest, num_cells, random))];
  }
  return visits;
}

// Pearson's statistic against expected shares.
double chiSquare(const std::vector<int64_t>& seen, const std::vector<double>& share) {
  const auto total = static_cast<double>(std::accumulate(seen.begin(), seen.end(), int64_t{0}));
  double sum = 0;
  for (size_t i = 0; i < seen.size(); ++i) {
    const double expected = total * share[i];
    sum += (static_cast<double>(seen[i]) - expected) * (static_cast<double>(seen[i]) - expected) / expected;
  }
  return sum;
}

// Beta(1, tau) has the distribution function 1 - (1 - x)^tau; 1 - x loses digits where x nears 1.
TEST(ScheduleTest, QuantilesInvertTheDistributionFunction) {
  for (const double tau : {0.25, 0.5, 0.7, 1.0, 2.0}) {
    for (const double u : {0.0, 0.1, 0.5, 0.9, 0.999}) {
      EXPECT_NEAR(1.0 - std::pow(1.0 - betaQuantile(u, tau), tau), u, 1e-7) << "tau " << tau;
    }
  }
}

TEST(ScheduleTest, TheMeanOfTheLawIsTwoThirdsAtTheDefaultTau) {
  double sum = 0;
  for (int i = 0; i < 1000; ++i) sum += betaQuantile((i + 0.5) / 1000.0, 0.5);
  EXPECT_NEAR(sum / 1000.0, 2.0 / 3.0, 1e-4);
}

// 19 degrees of freedom: mean 19, standard deviation 6.2; 50 is five of them above.
TEST(ScheduleTest, GlobalVisitsFollowTheBetaLaw) {
  const int32_t num_cells = 20;
  for (const double tau : {0.5, 0.7, 1.0, 3.0}) {
    std::vector<double> share;
    for (int32_t c = 0; c < num_cells; ++c) {
      const auto above = [&](int32_t cell) {
        return std::pow(1.0 - static_cast<double>(cell) / num_cells, tau);
      };
      share.push_back(above(c) - above(c + 1));
    }
    const auto seen = histogram({.tau = tau, .local_rate = 0.0}, {0}, num_cells, 100'000);
    EXPECT_LT(chiSquare(seen, share), 50.0) << "tau " << tau;
    if (tau < 1.0) {  // newest most often
      EXPECT_GT(seen.back(), seen.front());
    }
  }
}

// Local visits spread evenly over the latest cells: 1/2 + 1/2 of four cells, none elsewhere.
TEST(ScheduleTest, LocalVisitsSpreadEvenlyOverTheLatestCells) {
  const auto seen = histogram({.local_rate = 1.0}, {1, 3}, 4, 10'000);
  EXPECT_EQ(seen[0] + seen[2], 0);
  EXPECT_NEAR(static_cast<double>(seen[1]), 5000.0, 250.0);  // five standard deviations of 50
}

TEST(ScheduleTest, TheLocalRateIsTheShareOfLocalVisits) {
  // Cell 0 is the latest; with tau = 1 a global visit finds it once in 4: .3 + .7 / 4 = .475.
  const auto seen = histogram({.tau = 1.0, .local_rate = 0.3}, {0}, 4, 10'000);
  EXPECT_NEAR(static_cast<double>(seen[0]), 4750.0, 250.0);
}

TEST(ScheduleTest, EveryVisitIsGlobalWhenTheLatestImageWasEmpty) {
  const auto seen = histogram({.tau = 1.0, .local_rate = 1.0}, {}, 4, 10'000);
  for (const int64_t visits : seen) EXPECT_NEAR(static_cast<double>(visits), 2500.0, 220.0);
}

}  // namespace
}  // namespace shoal::topics
