// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/known_topics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "planted_map.h"
#include "shoal/topics/cell_label_model.h"
#include "shoal/topics/topic_model.h"

namespace shoal::topics {
namespace {

using world::RobotId;
using world::TopicId;

// Two topics of forty words, with ids that are not their places.
const std::vector<KnownTopic> kTwo = {{TopicId{7}, {{0, 400}, {1, 300}}},
                                      {TopicId{3}, {{10, 500}, {11, 400}}}};

std::string complaint(const std::vector<KnownTopic>& known, int32_t vocabulary = 20, int32_t most = 4) {
  try {
    check(known, vocabulary, most);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(KnownTopicsTest, SaysWhatIsWrongWithThem) {
  EXPECT_EQ(complaint(kTwo), "");
  EXPECT_NE(complaint(kTwo, 20, 1).find("at most 1"), std::string::npos);
  EXPECT_NE(complaint(kTwo, 11).find("topic 3: words"), std::string::npos);
  EXPECT_NE(complaint({kTwo[0], kTwo[0]}).find("topic 7 is there twice"), std::string::npos);
  EXPECT_NE(complaint({{TopicId{10000}, {{0, 1}}}}).find("[0, 9999]"), std::string::npos);
  EXPECT_NE(complaint({{TopicId{1}, {}}}).find("topic 1 has no words"), std::string::npos);
  EXPECT_NE(complaint({{TopicId{1}, {{3, 1}, {3, 1}}}}).find("at word 3"), std::string::npos);
  EXPECT_NE(complaint({{TopicId{1}, {{0, 1 << 30}, {1, 1}}}}).find("2^30"), std::string::npos);
}

// Cells of the one kind of words, then of the other, and of a third that nobody knew.
world::WordsInCells row(int32_t observation, int32_t word) {
  world::WordsInCells words{.observation = observation, .time = {observation * 1'000'000LL}, .cells = {}};
  for (int32_t x = 0; x < 6; ++x)
    words.cells.push_back({{x, 4 * observation, 0}, {{word, 7}, {word + 1, 5}}});
  return words;
}

// How many cells, of the twelve of known kinds, are told as what is known.
template <typename Model>
int numNamedFromTheFirstImage(Model model) {
  for (const auto& [observation, word] : {std::pair{0, 10}, {1, 0}, {2, 15}})
    model.observe(row(observation, word));
  const Snapshot snapshot = model.snapshot();
  int named = 0;
  for (const CellLabel& cell : snapshot.cells) {
    const TopicId meant = cell.cell.y == 0 ? TopicId{3} : TopicId{7};
    if (cell.cell.y < 8 && cell.topic == meant) ++named;
    const bool is_known = cell.topic == TopicId{3} || cell.topic == TopicId{7};
    // An id that was not known was never used.
    EXPECT_TRUE(is_known ? cell.cell.y < 8 : number(cell.topic) >= 8) << number(cell.topic);
  }
  int64_t words = 0;  // told are its own alone
  for (const TopicCounts& topic : snapshot.topics) {
    words += topic.weight;
    for (const world::WordCount& w : topic.words) EXPECT_LE(w.count, 6 * 7);
  }
  EXPECT_EQ(words, 3 * 6 * 12);
  return named;
}

// TopicModel draws each word for itself: one chain in twelve calls a whole row something else.
TEST(KnownTopicsTest, NameWhatIsSeenFromTheFirstImageOn) {
  int num_good = 0;
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    num_good += numNamedFromTheFirstImage(TopicModel(
                    {.max_topics = 4, .alpha = 0.1, .beta = 0.1, .resamples_per_observation = 2000}, 20, seed,
                    RobotId{0}, kTwo)) >= 8;
    EXPECT_EQ(numNamedFromTheFirstImage(CellLabelModel({.max_topics = 4, .cells_per_topic = 3},
                                                       {{.name = "all", .first = 0, .size = 20}}, seed,
                                                       RobotId{0}, kTwo)),
              12);
  }
  EXPECT_GE(num_good, 34);
}

// What was learnt in one flight names the same classes in the next, over another map of them.
TEST(KnownTopicsTest, AnEarlierFlightsTopicsNameTheSameClasses) {
  for (const uint64_t seed : {1, 2, 3}) {
    PlantedMap map(seed, 3);
    CellLabelModel first({}, PlantedMap::groups(), seed, RobotId{0});
    for (int32_t n = 0; n < 14; ++n) first.observe(map.image(n));
    std::vector<KnownTopic> known;
    for (const TopicCounts& topic : first.snapshot().topics) known.push_back({topic.id, topic.words});
    std::map<TopicId, std::map<int32_t, int>> meant;
    for (const CellLabel& c : first.snapshot().cells) ++meant[c.topic][map.classOf(c.cell)];
    const auto classOf = [&](TopicId id) {
      const auto& classes = meant[id];
      if (classes.empty()) return -1;
      return std::ranges::max_element(classes, {}, [](const auto& c) { return c.second; })->first;
    };
    CellLabelModel next({}, PlantedMap::groups(), seed + 10, RobotId{1}, known);
    for (int32_t n = 14; n < 20; ++n) next.observe(map.image(n));
    int right = 0, cells = 0;
    for (const CellLabel& c : next.snapshot().cells) {
      ++cells;
      right += classOf(c.topic) == map.classOf(c.cell);
    }
    EXPECT_GT(right, 0.9 * cells) << seed;
  }
}

TEST(KnownTopicsTest, ACheckpointGoesOnAndIsOfTheSameTopics) {
  const CellLabelHyperparameters cells{.max_topics = 4, .cells_per_topic = 3};
  const std::vector<world::WordGroup> groups = {{.name = "all", .first = 0, .size = 20}};
  CellLabelModel labels(cells, groups, 1, RobotId{0}, kTwo);
  labels.observe(row(0, 10));
  CellLabelModel again = CellLabelModel::resumed(cells, groups, 1, RobotId{0}, labels.checkpoint(), kTwo);
  EXPECT_THROW(CellLabelModel::resumed(cells, groups, 1, RobotId{0}, labels.checkpoint()),
               std::runtime_error);
  for (CellLabelModel* model : {&labels, &again}) model->observe(row(1, 5));
  EXPECT_EQ(again.checkpoint(), labels.checkpoint());

  const Hyperparameters words{.max_topics = 4, .alpha = 0.1, .beta = 0.1, .resamples_per_observation = 500};
  TopicModel topics(words, 20, 1, RobotId{0}, kTwo);
  topics.observe(row(0, 10));
  TopicModel resumed = TopicModel::resumed(words, 20, 1, RobotId{0}, topics.checkpoint(), kTwo);
  EXPECT_THROW(TopicModel::resumed(words, 20, 1, RobotId{0}, topics.checkpoint()), std::runtime_error);
  for (TopicModel* model : {&topics, &resumed}) model->observe(row(1, 5));
  EXPECT_EQ(resumed.checkpoint(), topics.checkpoint());
}

// Without anything known nothing is different.
TEST(KnownTopicsTest, NoneChangeNothing) {
  PlantedMap map(4, 3);
  CellLabelModel plain({}, PlantedMap::groups(), 1, RobotId{0}),
      none({}, PlantedMap::groups(), 1, RobotId{0}, {});
  const world::WordsInCells image = map.image(0);
  plain.observe(image);
  none.observe(image);
  EXPECT_EQ(plain.checkpoint(), none.checkpoint());
}

}  // namespace
}  // namespace shoal::topics
