// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/ami.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "shoal/random.h"

namespace shoal::eval {
namespace {

std::vector<int> labelling(int size, const std::function<int(int)>& label) {
  std::vector<int> labels;
  for (int n = 0; n < size; ++n) labels.push_back(label(n));
  return labels;
}

std::vector<int> randomLabelling(Random& random, int size, int num_labels) {
  return labelling(size,
                   [&](int) { return static_cast<int>(random.below(static_cast<uint64_t>(num_labels))); });
}

TEST(ContingencyTest, CountsWhatWasCountedByHand) {
  const std::vector<int> label{7, 7, -3, 7, -3, 90000};
  const std::vector<int> truth{1, 2, 2, 1, 2, 1};
  const Contingency table = contingency(label, truth);
  EXPECT_EQ(table.label_ids, (std::vector{-3, 7, 90000}));
  EXPECT_EQ(table.truth_ids, (std::vector{1, 2}));
  EXPECT_EQ(table.label_cells, (std::vector<int64_t>{2, 3, 1}));
  EXPECT_EQ(table.truth_cells, (std::vector<int64_t>{3, 3}));
  const std::vector<Contingency::Count> expected{{0, 1, 2}, {1, 0, 2}, {1, 1, 1}, {2, 0, 1}};
  EXPECT_EQ(table.counts, expected);
  EXPECT_EQ(table.num_cells, 6);
}

// Few or many ids, close together or at the ends of the numbers: the table or the sort, the counts are the
// same.
TEST(ContingencyTest, AgreesWithAMapWhateverTheIds) {
  Random random(5);
  for (const int num_ids : {1, 3, 40, 3000}) {
    for (const int spread : {1, 700'000}) {
      SCOPED_TRACE(std::to_string(num_ids) + " ids, " + std::to_string(spread) + " apart");
      auto label = randomLabelling(random, 4000, num_ids);
      const auto truth = randomLabelling(random, 4000, num_ids);
      std::map<std::pair<int, int>, int64_t> expected;
      for (size_t n = 0; n < label.size(); ++n) {
        label[n] = std::numeric_limits<int>::min() + label[n] * spread;
        ++expected[{label[n], truth[n]}];
      }
      const Contingency table = contingency(label, truth);
      std::map<std::pair<int, int>, int64_t> counted;
      for (const Contingency::Count& c : table.counts) {
        counted[{table.label_ids[static_cast<size_t>(c.label)],
                 table.truth_ids[static_cast<size_t>(c.truth)]}] = c.cells;
      }
      EXPECT_EQ(counted, expected);
      EXPECT_EQ(counted.size(), table.counts.size());
    }
  }
}

// Several threads' worth.
TEST(ContingencyTest, CountsManyCells) {
  const size_t cells = 5'000'000;
  std::vector<int> label(cells, 3), truth(cells, 7);
  truth[cells - 1] = 1 << 30;  // too far for a table
  for (size_t n = 0; n < cells; n += 1000) label[n] = 4;
  const Contingency table = contingency(label, truth);
  EXPECT_EQ(table.num_cells, static_cast<int64_t>(cells));
  const auto others = static_cast<int64_t>((cells + 999) / 1000);
  EXPECT_EQ(table.label_cells, (std::vector<int64_t>{static_cast<int64_t>(cells) - others, others}));
  EXPECT_EQ(table.truth_cells, (std::vector<int64_t>{static_cast<int64_t>(cells) - 1, 1}));
}

TEST(ContingencyTest, RejectsLabellingsOfDifferentLength) {
  EXPECT_THROW(static_cast<void>(contingency(std::vector{1, 2}, std::vector{1})), std::invalid_argument);
}

// from sklearn.metrics import adjusted_mutual_info_score as a, normalized_mutual_info_score as m
// from sklearn.metrics.cluster import contingency_matrix as c, expected_mutual_information as e   (1.2.1)
// a(y, x, average_method="max"), m(y, x, average_method="max"), e(c(x, y, sparse=True), len(x))
TEST(AmiTest, HasTheValuesOfScikitLearn) {
  struct Case {
    const char* name;
    std::vector<int> label, truth;
    double ami, nmi, expected;
  };
  const Case cases[] = {
      {"grid", labelling(60, [](int n) { return n * n / 7 % 5; }),
       labelling(60, [](int n) { return n / 9 % 4; }), -0.03313558997841848, 0.04220847687069896,
       0.11485981911090833},
      {"near", labelling(60, [](int n) { return n / 10 + (n % 7 == 0); }),
       labelling(60, [](int n) { return n / 10; }), 0.7340628432482516, 0.7755706033101755,
       0.2870449651370827},
      {"crossed", labelling(40, [](int n) { return n % 2; }), labelling(40, [](int n) { return n / 2 % 2; }),
       -0.019100164197487664, 0.0, 0.012991092953209462},
      {"one constant", labelling(30, [](int) { return 3; }), labelling(30, [](int n) { return n % 3; }), 0.0,
       0.0, 0.0},
      {"many small", labelling(50, [](int n) { return n / 2; }), labelling(50, [](int n) { return n / 5; }),
       0.32065741577065726, 0.6722706232293574, 1.6660213557451407},
      {"negative", {0, 0, 1, 1, 2, 2}, {0, 1, 0, 1, 0, 1}, -0.33756342479746365, 0.0, 0.2772588722239782},
      {"unequal", labelling(60, [](int n) { return n < 57 ? 0 : n - 56; }),
       labelling(60, [](int n) { return n / 30; }), 0.0013562756001755053, 0.051899160321315474,
       0.035081237868770224},
      {"large", labelling(20000, [](int n) { return n % 11 * (n % 11) % 11; }),
       labelling(20000, [](int n) { return n % 11 / 2; }), 0.6434174096345312, 0.6435435381939845,
       0.0006252935182916828},
      {"all alone", {0, 1, 2, 3}, {0, 1, 2, 3}, 0.0, 1.0, 1.3862943611198906},
      {"both constant", {1, 1, 1, 1, 1}, {2, 2, 2, 2, 2}, 1.0, 1.0, 0.0},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    const Contingency table = contingency(c.label, c.truth);
    EXPECT_NEAR(ami(table), c.ami, 1e-9);
    EXPECT_NEAR(nmi(table), c.nmi, 1e-12);
    EXPECT_NEAR(expectedMutualInformation(table), c.expected, 1e-10);  // scikit-learn's own round-off
  }
}

// The definition: the mean over all orders of the cells.
TEST(AmiTest, ExpectationIsTheMeanOverAllPermutations) {
  Random random(11);
  for (int trial = 0; trial < 12; ++trial) {
    const int size = 2 + trial % 6;
    const auto label = randomLabelling(random, size, 1 + trial % 4);
    auto truth = randomLabelling(random, size, 1 + trial % 3);
    std::vector<int> order(truth.size());
    std::iota(order.begin(), order.end(), 0);
    double sum = 0.0;
    int count = 0;
    do {
      std::vector<int> shuffled;
      for (const int n : order) shuffled.push_back(truth[static_cast<size_t>(n)]);
      sum += mutualInformation(contingency(label, shuffled));
      ++count;
    } while (std::next_permutation(order.begin(), order.end()));
    EXPECT_NEAR(expectedMutualInformation(contingency(label, truth)), sum / count,
                1e-12);  // round-off of 5040 terms
  }
}

TEST(AmiTest, IsOneForLabellingsThatGroupAlikeAndNamesDoNotMatter) {
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const auto truth = randomLabelling(random, 200, 2 + trial);
    auto label = truth;
    for (int& l : label) l = 1000 - 7 * l;
    EXPECT_NEAR(ami(contingency(label, truth)), 1.0, 1e-12);
    EXPECT_NEAR(nmi(contingency(label, truth)), 1.0, 1e-12);
  }
}

TEST(AmiTest, IsSymmetricAndInvariantUnderTheOrderOfCells) {
  Random random(4);
  for (int trial = 0; trial < 20; ++trial) {
    auto label = randomLabelling(random, 100, 2 + trial % 7);
    auto truth = randomLabelling(random, 100, 3 + trial % 4);
    const double value = ami(contingency(label, truth));
    EXPECT_NEAR(ami(contingency(truth, label)), value, 1e-12);
    std::reverse(label.begin(), label.end());
    std::reverse(truth.begin(), truth.end());
    EXPECT_EQ(ami(contingency(label, truth)), value);
  }
}

// 200 independent pairs; the standard error of their mean is below .001, MI alone would be above .05.
TEST(AmiTest, IsZeroOnAverageForIndependentLabellings) {
  Random random(6);
  double sum_ami = 0.0;
  double sum_mutual = 0.0;
  for (int trial = 0; trial < 200; ++trial) {
    const Contingency table = contingency(randomLabelling(random, 150, 6), randomLabelling(random, 150, 5));
    sum_ami += ami(table);
    sum_mutual += mutualInformation(table);
  }
  EXPECT_NEAR(sum_ami / 200, 0.0, .005);
  EXPECT_GT(sum_mutual / 200, .05);
}

// The paper's authors once had 1 here.
TEST(AmiTest, IsZeroForAMapOfOneLabelOverSeveralClasses) {
  EXPECT_NEAR(ami(contingency(std::vector(90, 4), labelling(90, [](int n) { return n % 5; }))), 0.0, 1e-12);
}

TEST(AmiTest, IsZeroWithoutCells) {
  EXPECT_EQ(ami(contingency({}, {})), 0.0);
  EXPECT_EQ(nmi(contingency({}, {})), 0.0);
}

// The sum over ten million cells keeps its digits: E[MI] of independent labellings is about
// (labels - 1)(classes - 1) / 2N (Vinh et al. 2010), here 5.4e-6.
TEST(AmiTest, StaysExactForTenMillionCells) {
  Contingency table;
  table.num_cells = 10'000'000;
  table.label_cells.assign(10, 1'000'000);
  table.truth_cells.assign(13, 769'230);
  table.truth_cells.back() += 10;
  EXPECT_NEAR(expectedMutualInformation(table) / (9. * 12. / 2e7), 1.0, 1e-5);
}

// Where sets have thousands of cells in common the sum gives way to a series: against the sum over the whole
// hypergeometric distribution, in extended precision, on both sides of the change and for lopsided margins.
TEST(AmiTest, ExpectationAgreesWithTheWholeSumForLargeTables) {
  const auto byDefinition = [](const Contingency& table) {
    const auto choose = [](int64_t n, int64_t k) {
      const auto fact = [](int64_t x) { return std::lgammal(static_cast<long double>(x) + 1); };
      return fact(n) - fact(k) - fact(n - k);
    };
    long double sum = 0;
    const int64_t total = table.num_cells;
    for (const int64_t a : table.label_cells) {
      for (const int64_t b : table.truth_cells) {
        for (int64_t n = std::max<int64_t>(1, a + b - total); n <= std::min(a, b); ++n) {
          const long double x = static_cast<long double>(n), t = static_cast<long double>(total);
          sum += std::exp(choose(a, n) + choose(total - a, b - n) - choose(total, b)) * x / t *
                 std::log(x * t / (static_cast<long double>(a) * static_cast<long double>(b)));
        }
      }
    }
    return static_cast<double>(sum);
  };
  for (const auto& [labels, truths] : std::vector<std::pair<std::vector<int64_t>, std::vector<int64_t>>>{
           {{8000, 8200}, {8100, 8100}},
           {{8400, 8300}, {8350, 8350}},
           {{199000, 1000}, {150000, 50000}},
           {{60000, 30000, 9000}, {90000, 8000, 1000}}}) {
    Contingency table;
    table.label_cells = labels;
    table.truth_cells = truths;
    table.num_cells = std::accumulate(labels.begin(), labels.end(), int64_t{0});
    const double expected = byDefinition(table);
    EXPECT_NEAR(expectedMutualInformation(table) / expected, 1.0, 1e-6) << table.num_cells;
  }
}

}  // namespace
}  // namespace shoal::eval
