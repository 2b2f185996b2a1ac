// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/ami_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "shoal/eval/ami.h"
#include "shoal/random.h"

namespace shoal::eval {
namespace {

// A map and what is there. Each label is a class's, so many cells of it are that class, the others are what
// the cells of another label are.
struct MadeMap {
  int labels, classes;
  double right;
};

struct Cells {
  std::vector<int> label, name;
  double ami() const { return eval::ami(contingency(label, name)); }
};

int oneOf(Random& random, const std::vector<double>& weights) {
  double sum = 0.0;
  for (const double w : weights) sum += w;
  double left = random.uniform() * sum;
  size_t i = 0;
  while (i + 1 < weights.size() && left >= weights[i]) left -= weights[i++];
  return static_cast<int>(i);
}

Cells make(const MadeMap& map, Random& random, int num_cells) {
  std::vector<double> size;
  std::vector<int> class_of;
  for (int l = 0; l < map.labels; ++l) {
    const double share = -std::log(1.0 - random.uniform());
    size.push_back(share * share);
    class_of.push_back(l < map.classes ? l
                                       : static_cast<int>(random.below(static_cast<uint64_t>(map.classes))));
  }
  Cells cells;
  for (int c = 0; c < num_cells; ++c) {
    const int label = oneOf(random, size);
    const int is = random.uniform() < map.right ? label : oneOf(random, size);
    cells.label.push_back(label);
    cells.name.push_back(class_of[static_cast<size_t>(is)]);
  }
  return cells;
}

// So many cells, drawn without replacement; those of `all` change places.
Cells draw(Cells& all, int count, Random& random) {
  Cells drawn;
  for (size_t i = 0; i < static_cast<size_t>(count); ++i) {
    const size_t j = i + random.below(all.label.size() - i);
    std::swap(all.label[i], all.label[j]);
    std::swap(all.name[i], all.name[j]);
    drawn.label.push_back(all.label[i]);
    drawn.name.push_back(all.name[i]);
  }
  return drawn;
}

TEST(AmiEstimateTest, TheIntervalHoldsTheWholeMapsAmi) {
  constexpr MadeMap kMaps[] = {{6, 6, .99}, {5, 5, 1},  {8, 6, .9}, {17, 6, .7},
                               {25, 8, .4}, {12, 6, 0}, {2, 2, .8}, {40, 10, .6}};
  constexpr int kDraws = 150, kCells = 4000;
  double all_held = 0.0, all = 0.0;
  for (const MadeMap& map : kMaps) {
    for (const int count : {20, 50, 100, 200}) {
      int held = 0;
      double off = 0.0, width = 0.0;
      for (uint64_t d = 0; d < kDraws; ++d) {
        Random random(1, d, static_cast<uint64_t>(count), static_cast<uint64_t>(map.labels));
        Cells cells = make(map, random, kCells);
        const double ami = cells.ami();
        const Cells drawn = draw(cells, count, random);
        const AmiEstimate e = estimateAmi(drawn.label, drawn.name, kCells);
        ASSERT_LE(e.low, e.high);
        held += ami >= e.low - 1e-9 && ami <= e.high + 1e-9 ? 1 : 0;
        off += (e.ami - ami) / kDraws;
        width += (e.high - e.low) / kDraws;
      }
      EXPECT_GE(held, kDraws * .84) << map.labels << " labels, right " << map.right << ", " << count
                                    << " cells";
      EXPECT_LT(std::abs(off), .06) << map.labels << " labels, right " << map.right << ", " << count
                                    << " cells";
      EXPECT_LT(width, 1.3) << map.labels << " labels, right " << map.right << ", " << count << " cells";
      all_held += held;
      all += kDraws;
    }
  }
  EXPECT_GE(all_held / all, .935);
  EXPECT_LE(all_held / all, .98);
}

TEST(AmiEstimateTest, AllCellsTellItExactly) {
  Random random(2);
  const Cells cells = make({9, 5, .6}, random, 300);
  const AmiEstimate e = estimateAmi(cells.label, cells.name, 300);
  EXPECT_DOUBLE_EQ(e.ami, cells.ami());
  EXPECT_DOUBLE_EQ(e.low, cells.ami());
  EXPECT_DOUBLE_EQ(e.high, cells.ami());
}

TEST(AmiEstimateTest, IsTheJackknifeOfEachCellLeftOutInTurn) {
  Random random(3);
  const Cells cells = make({6, 4, .7}, random, 60);
  double mean = 0.0, squares = 0.0;
  std::vector<double> without;
  for (std::ptrdiff_t i = 0; i < 60; ++i) {
    Cells less = cells;
    less.label.erase(less.label.begin() + i);
    less.name.erase(less.name.begin() + i);
    without.push_back(less.ami());
    mean += without.back() / 60;
  }
  for (const double w : without) squares += (w - mean) * (w - mean);
  const double error = std::sqrt(59.0 / 60 * squares);
  const AmiEstimate e = estimateAmi(cells.label, cells.name, int64_t{1} << 60);
  EXPECT_NEAR(e.ami, 60 * cells.ami() - 59 * mean, 1e-9);
  EXPECT_NEAR(e.high, e.ami + 1.96 * error, 1e-9);
  EXPECT_NEAR(e.low, e.ami - 1.96 * error, 1e-9);
}

TEST(AmiEstimateTest, ThirtyCellsWithoutAMistakeAreNoProof) {
  std::vector<int> label, name;
  for (int i = 0; i < 30; ++i) {
    label.push_back(i % 3);
    name.push_back(10 + i % 3);
  }
  const AmiEstimate e = estimateAmi(label, name, 100'000);
  EXPECT_EQ(e.ami, 1.0);
  EXPECT_EQ(e.high, 1.0);
  for (const int other : {11, 11, 11}) {  // the first label's cells that were not met may be another's
    label.push_back(0);
    name.push_back(other);
  }
  EXPECT_NEAR(e.low, ami(contingency(label, name)), 1e-12);
}

TEST(AmiEstimateTest, OneNameForAllTellsNothing) {
  const std::vector<int> label(40, 7), name(40, 1);
  const AmiEstimate e = estimateAmi(label, name, 1000);
  EXPECT_EQ(e.high, 1.0);
  EXPECT_LE(e.low, 0.0);
}

TEST(AmiEstimateTest, TooFewCellsAreRefused) {
  EXPECT_THROW(estimateAmi(std::vector<int>(19, 1), std::vector<int>(19, 1), 100), std::invalid_argument);
  EXPECT_THROW(estimateAmi(std::vector<int>(30, 1), std::vector<int>(29, 1), 100), std::invalid_argument);
}

}  // namespace
}  // namespace shoal::eval
