// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/surprise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "planted_map.h"
#include "shoal/topics/cell_label_model.h"
#include "shoal/topics/fixed_log.h"
#include "shoal/topics/topic_model.h"

namespace shoal::topics {
namespace {

// -1/5 log2(1/4 2^-30 + 3/4 2^-28); the third label has no cell.
TEST(SurpriseTest, IsThePerplexityWorkedByHand) {
  const std::vector<int64_t> logs = {-30 * kLogOne, -28 * kLogOne, -1 * kLogOne};
  const double expected = -std::log2(0.25 * std::exp2(-30) + 0.75 * std::exp2(-28)) / 5;
  EXPECT_NEAR(bitsPerWord(logs, std::vector<int32_t>{1, 3, 0}, 5), expected, 1e-4);
  EXPECT_NEAR(bitsPerWord(logs, std::vector<int32_t>{7, 0, 0}, 5), 30.0 / 5, 1e-4);
}

// Two cells of other words, far apart; V = 3, beta = 1: (4 + 1) / (4 + 3) for a word of one's own, 1 / 7 for
// another's.
TEST(SurpriseTest, TheNeighborhoodIsTheCellAndWhatAdjoinsIt) {
  CellLabelModel model({.cells_per_topic = 1, .evidence = 100, .beta = 1},
                       {{.name = "all", .first = 0, .size = 3}}, 1, world::RobotId{0});
  world::WordsInCells image{
      .observation = 0, .time = {}, .cells = {{{0, 0, 0}, {{0, 4}}}, {{9, 0, 0}, {{1, 4}}}}};
  EXPECT_EQ(model.surprise(image, Surroundings::kGlobal), (std::vector<double>{0, 0}));
  model.add(image);
  model.refine(100);
  ASSERT_EQ(model.numTopics(), 2);
  image.cells = {{{0, 0, 0}, {{0, 1}}}, {{0, 1, 0}, {{1, 1}}}, {{5, 5, 5}, {{0, 1}}}};
  const double own = -std::log2(5.0 / 7), other = -std::log2(1.0 / 7), mixed = -std::log2(3.0 / 7);
  const auto near = model.surprise(image, Surroundings::kNeighborhood);
  const auto global = model.surprise(image, Surroundings::kGlobal);
  EXPECT_NEAR(near[0], own, 1e-3);
  EXPECT_NEAR(near[1], other, 1e-3);
  EXPECT_NEAR(near[2], mixed, 1e-3);  // adjoins nothing: the whole map
  for (const double bits : global) EXPECT_NEAR(bits, mixed, 1e-3);
}

// One class of five is kept from the robot; then it shows it. At first sight its cells surprise more than all
// but a few of the others; some images later they do no more.
TEST(SurpriseTest, FindsAPlantedNoveltyAtFirstSight) {
  for (const uint64_t seed : {1, 2, 3}) {
    PlantedMap map(seed, 5);
    CellLabelModel model({}, PlantedMap::groups(), seed, world::RobotId{0});
    const auto isNovel = [&](const world::CellWords& cell) { return map.classOf(cell.cell) == 4; };
    // How often a novel cell of the image surprises more than a known one.
    const auto chance = [&](const world::WordsInCells& image) {
      const std::vector<double> bits = model.surprise(image, Surroundings::kGlobal);
      double more = 0, pairs = 0;
      for (size_t i = 0; i < bits.size(); ++i) {
        for (size_t j = 0; j < bits.size(); ++j) {
          if (!isNovel(image.cells[i]) || isNovel(image.cells[j])) continue;
          more += bits[i] > bits[j];
          ++pairs;
        }
      }
      return more / pairs;
    };
    for (int32_t n = 0; n < 14; ++n) {
      world::WordsInCells image = map.image(n);
      std::erase_if(image.cells, isNovel);
      model.observe(image);
    }
    EXPECT_GT(chance(map.image(14)), 0.9);
    for (int32_t n = 14; n < 20; ++n) model.observe(map.image(n));
    EXPECT_LT(chance(map.image(20)), 0.75);
  }
}

// The map keeps it: cells of the kept class stand out from the image that first showed them.
TEST(SurpriseTest, TheMapRemembersWhatSurprised) {
  for (const uint64_t seed : {1, 2, 3}) {
    PlantedMap map(seed, 5);
    CellLabelModel model({}, PlantedMap::groups(), seed, world::RobotId{0});
    const auto isNovel = [&](const world::CellIndex& cell) { return map.classOf(cell) == 4; };
    for (int32_t n = 0; n < 14; ++n) {
      world::WordsInCells image = map.image(n);
      std::erase_if(image.cells, [&](const world::CellWords& cell) { return isNovel(cell.cell); });
      model.observe(image);
    }
    for (int32_t n = 14; n < 17; ++n) model.observe(map.image(n));
    double novel = 0, found = 0, others = 0, wrong = 0;
    for (const CellLabel& c : model.snapshot().cells) {
      (isNovel(c.cell) ? novel : others) += 1;
      if (c.surprise >= 1.5f) (isNovel(c.cell) ? found : wrong) += 1;
    }
    ASSERT_GT(novel, 10);
    EXPECT_GT(found / novel, 0.3) << seed;
    EXPECT_GT(found / novel, 5 * wrong / others) << found / novel << " of them, " << wrong / others << seed;
  }
}

// One topic of four words of one kind, V = 3, β = 1: (4 + 1) / (4 + 3) for that word, 1 / 7 for another.
TEST(SurpriseTest, OfWordTopicsIsThePerplexityWorkedByHand) {
  TopicModel model({.max_topics = 1, .alpha = 1, .beta = 1, .gamma = 0}, 3, 1, world::RobotId{0});
  world::WordsInCells image{.observation = 0, .time = {}, .cells = {{{0, 0, 0}, {{0, 4}}}}};
  EXPECT_EQ(model.surprise(image), std::vector<double>{0});
  model.add(image);
  image.cells = {{{5, 0, 0}, {{0, 1}}}, {{6, 0, 0}, {{0, 1}, {2, 3}}}};
  const double own = -std::log2(5.0 / 7), other = -std::log2(1.0 / 7);
  EXPECT_NEAR(model.surprise(image)[0], own, 1e-3);
  EXPECT_NEAR(model.surprise(image)[1], (own + 3 * other) / 4, 1e-3);
}

TEST(SurpriseTest, RefusesWordsThatBreakTheirContract) {
  const CellLabelModel model({}, PlantedMap::groups(), 1, world::RobotId{0});
  const world::WordsInCells bad{.observation = 0, .time = {}, .cells = {{{0, 0, 0}, {{100, 1}}}}};
  EXPECT_THROW(model.surprise(bad, Surroundings::kGlobal), std::invalid_argument);
}

}  // namespace
}  // namespace shoal::topics
