// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/make_learner.h"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>
#include <vector>

#include "shoal/topics/cell_label_model.h"
#include "shoal/topics/topic_model.h"

namespace shoal::topics {
namespace {

const std::vector<world::WordGroup> kGroups = {{.name = "a", .first = 0, .size = 3},
                                               {.name = "b", .first = 3, .size = 2}};

TEST(MakeLearnerTest, TheKindOfHyperparametersIsTheKindOfLearner) {
  const auto words = makeLearner(Hyperparameters{}, kGroups, 1, world::RobotId{0});
  EXPECT_NE(dynamic_cast<TopicModel*>(words.get()), nullptr);
  EXPECT_EQ(words->snapshot().vocabulary_size, 5);
  const auto cells = makeLearner(CellLabelHyperparameters{}, kGroups, 1, world::RobotId{0});
  EXPECT_NE(dynamic_cast<CellLabelModel*>(cells.get()), nullptr);
  EXPECT_EQ(cells->snapshot().vocabulary_size, 5);
}

TEST(MakeLearnerTest, RefusesBadHyperparametersAndNoWords) {
  EXPECT_THROW(makeLearner(Hyperparameters{.alpha = -1}, kGroups, 1, {}), std::invalid_argument);
  EXPECT_THROW(makeLearner(CellLabelHyperparameters{.beta = -1}, kGroups, 1, {}), std::invalid_argument);
  EXPECT_THROW(makeLearner(Hyperparameters{}, {}, 1, {}), std::invalid_argument);
  EXPECT_THROW(makeLearner(CellLabelHyperparameters{}, {}, 1, {}), std::invalid_argument);
}

TEST(MakeLearnerTest, EveryHyperparameterIsInTheFingerprint) {
  std::vector<Hyperparameters> words(9);
  words[1].max_topics = 7;
  words[2].alpha = 0.2;
  words[3].beta = 0.2;
  words[4].gamma = 0.2;
  words[5].neighbor_weight = 0.2;
  words[6].tau = 0.9;
  words[7].local_rate = 0.2;
  words[8].resamples_per_observation = 3000;
  std::vector<CellLabelHyperparameters> cells(10);
  cells[1].max_topics = 7;
  cells[2].cells_per_topic = 7;
  cells[3].evidence = 2;
  cells[4].beta = 0.7;
  cells[5].coupling = 0.2;
  cells[6].tau = 0.9;
  cells[7].local_rate = 0.6;
  cells[8].visits_per_cell = 3;
  cells[9].twin_similarity = 0.2;
  std::set<uint64_t> prints;
  for (const Hyperparameters& h : words) prints.insert(fingerprint(h));
  for (const CellLabelHyperparameters& h : cells) prints.insert(fingerprint(h));
  EXPECT_EQ(prints.size(), 19u);
  EXPECT_EQ(fingerprint(words[0]), fingerprint(Hyperparameters{}));
}

}  // namespace
}  // namespace shoal::topics
