// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/cell_label_model.h"
#include "shoal/topics/cell_certainty.h"
#include "shoal/topics/fixed_log.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "planted_map.h"
#include "shoal/random.h"

namespace shoal::topics {
namespace {

using world::CellIndex;
using world::CellWords;
using world::RobotId;
using world::Timestamp;
using world::WordGroup;
using world::WordsInCells;

WordsInCells image(int32_t observation, std::vector<CellWords> cells) {
  return {
      .observation = observation, .time = Timestamp{observation * 1'000'000LL}, .cells = std::move(cells)};
}

const std::vector<WordGroup> kThreeWords = {{.name = "all", .first = 0, .size = 3}};

// Everything a snapshot says, as text with exact floats: equal iff the bytes are.
std::string dump(const Snapshot& s) {
  std::string out = std::to_string(s.vocabulary_size);
  for (const TopicCounts& t : s.topics) {
    out += "\nt" + std::to_string(number(t.id)) + ' ' + std::to_string(t.created.us) + ' ' +
           std::to_string(t.weight);
    for (const auto& [word, count] : t.words) out += ' ' + std::to_string(word) + ':' + std::to_string(count);
  }
  for (const CellLabel& c : s.cells) {
    out += '\n';
    for (const int64_t value :
         {int64_t{c.cell.x}, int64_t{c.cell.y}, int64_t{c.cell.z}, int64_t{number(c.topic)},
          int64_t{std::bit_cast<uint32_t>(c.certainty)}, int64_t{c.seen_observation}, c.seen.us}) {
      out += std::to_string(value) + ' ';
    }
  }
  return out;
}

std::string mission(const CellLabelHyperparameters& h, uint64_t seed, RobotId robot,
                    int32_t num_images = 12) {
  CellLabelModel model(h, PlantedMap::groups(), seed, robot);
  PlantedMap map(3, 4);
  for (int32_t i = 0; i < num_images; ++i) model.observe(map.image(i));
  return dump(model.snapshot());
}

TEST(CellLabelModelTest, KnowsNothingBeforeTheFirstImage) {
  CellLabelModel model({}, kThreeWords, 1, RobotId{0});
  model.refine(1000);
  const Snapshot snapshot = model.snapshot();
  EXPECT_EQ(snapshot.vocabulary_size, 3);
  EXPECT_TRUE(snapshot.topics.empty());
  EXPECT_TRUE(snapshot.cells.empty());
}

// Every topic's counts are the sum of the words of the cells that it labels, whatever has moved: checked
// after every single visit against the words that went in.
TEST(CellLabelModelTest, ATopicIsTheWordsOfItsCellsAfterEveryMove) {
  CellLabelModel model({.max_topics = 6, .cells_per_topic = 8, .evidence = 2}, PlantedMap::groups(), 1,
                       RobotId{0});
  PlantedMap map(5, 3);
  std::map<CellIndex, std::map<int32_t, int32_t>> words_of;
  std::map<CellIndex, int32_t> seen;
  int64_t moves = 0;
  std::string last;
  for (int32_t i = 0; i < 8; ++i) {
    const WordsInCells words = map.image(i);
    for (const CellWords& cell : words.cells) {
      seen[cell.cell] = i;
      for (const auto& [word, count] : cell.words) words_of[cell.cell][word] += count;
    }
    model.add(words);
    for (int visit = 0; visit < 40; ++visit) {
      model.refine(1);
      const Snapshot snapshot = model.snapshot();
      const std::vector<world::TopicId> drawn = model.drawnTopics();
      ASSERT_EQ(snapshot.cells.size(), seen.size());
      ASSERT_EQ(drawn.size(), seen.size());
      std::map<int32_t, std::map<int32_t, int32_t>> expected;
      auto known = seen.begin();
      std::string labels;
      for (const CellLabel& label : snapshot.cells) {
        ASSERT_EQ(label.cell, known->first);
        ASSERT_EQ(label.seen_observation, known->second);
        ASSERT_EQ(label.seen.us, known->second * 1'000'000LL);
        ASSERT_GE(label.certainty, 0.0F);
        ASSERT_LE(label.certainty, 1.0F);
        const int32_t topic = number(drawn[static_cast<size_t>(&label - snapshot.cells.data())]);
        for (const auto& [word, count] : words_of[label.cell]) expected[topic][word] += count;
        labels += std::to_string(topic) + ' ';
        ++known;
      }
      moves += labels != last;
      last = labels;
      ASSERT_EQ(snapshot.topics.size(), expected.size());
      ASSERT_EQ(std::ssize(snapshot.topics), model.numTopics());
      int32_t last_id = -1;
      for (const TopicCounts& topic : snapshot.topics) {
        ASSERT_GT(number(topic.id), last_id);
        last_id = number(topic.id);
        std::vector<world::WordCount> counts;
        int64_t weight = 0;
        for (const auto& [word, count] : expected.at(last_id)) {
          counts.push_back({word, count});
          weight += count;
        }
        ASSERT_EQ(topic.words, counts);
        ASSERT_EQ(topic.weight, weight);
      }
    }
  }
  EXPECT_GT(moves, 100);  // else nothing was tried
}

// Three cells in a row, two labels: eight states. The chain's matrix from the formula in floating point, its
// stationary law by repeated multiplication, against how often the model is in each partition (names of
// labels come and go; which cells are alike does not).
//
//     A - B - C        words: A {0,0,0,1}  B {0,1,2}  C {2,2,1}
TEST(CellLabelModelTest, ItsLongRunIsThatOfTheChainWorkedByBruteForce) {
  const double evidence = 2.1, beta = 0.5, coupling = 0.8;
  const std::array<std::array<double, 3>, 3> words = {{{3, 1, 0}, {1, 1, 1}, {0, 1, 2}}};
  const auto chance = [&](const std::array<int, 3>& z, int cell, int label) {
    std::array<double, 2> weight{};
    for (int k = 0; k < 2; ++k) {
      std::array<double, 3> count{};
      double total = 0;
      for (int c = 0; c < 3; ++c) {
        if (c == cell || z[static_cast<size_t>(c)] != k) continue;
        for (size_t w = 0; w < 3; ++w) {
          count[w] += words[static_cast<size_t>(c)][w];
          total += words[static_cast<size_t>(c)][w];
        }
      }
      double log = 0;
      for (size_t w = 0; w < 3; ++w) {
        log += words[static_cast<size_t>(cell)][w] * std::log((count[w] + beta) / (total + 3 * beta));
      }
      log *= evidence / (cell == 0 ? 4 : 3);
      for (const int neighbor : {cell - 1, cell + 1}) {
        if (neighbor >= 0 && neighbor < 3 && z[static_cast<size_t>(neighbor)] == k) log += coupling;
      }
      weight[static_cast<size_t>(k)] = std::exp(log);
    }
    return weight[static_cast<size_t>(label)] / (weight[0] + weight[1]);
  };
  std::array<double, 8> law;
  law.fill(1.0 / 8);
  for (int step = 0; step < 500; ++step) {
    std::array<double, 8> next{};
    for (int state = 0; state < 8; ++state) {
      const std::array<int, 3> z = {state & 1, state >> 1 & 1, state >> 2 & 1};
      for (int cell = 0; cell < 3; ++cell) {
        for (int label = 0; label < 2; ++label) {
          const int to = (state & ~(1 << cell)) | label << cell;
          next[static_cast<size_t>(to)] += law[static_cast<size_t>(state)] * chance(z, cell, label) / 3;
        }
      }
    }
    law = next;
  }
  // Partitions by (A = B, B = C).
  std::map<std::pair<bool, bool>, double> expected, seen;
  for (int state = 0; state < 8; ++state) {
    const int a = state & 1, b = state >> 1 & 1, c = state >> 2 & 1;
    expected[{a == b, b == c}] += law[static_cast<size_t>(state)];
  }

  const int num_models = 20, num_samples = 1500;  // a model each, for ids run out at 10 000
  for (uint64_t seed = 0; seed < num_models; ++seed) {
    CellLabelModel model({.max_topics = 2,
                          .evidence = evidence,
                          .beta = beta,
                          .coupling = coupling,
                          .tau = 1.0,
                          .twin_similarity = 1},
                         kThreeWords, seed, RobotId{0});
    model.add(image(0, {{{0, 0, 0}, {{0, 3}, {1, 1}}},
                        {{1, 0, 0}, {{0, 1}, {1, 1}, {2, 1}}},
                        {{2, 0, 0}, {{1, 1}, {2, 2}}}}));
    for (int i = 0; i < num_samples; ++i) {
      model.refine(5);
      const std::vector<world::TopicId> drawn = model.drawnTopics();
      seen[{drawn[0] == drawn[1], drawn[1] == drawn[2]}] += 1.0 / (num_models * num_samples);
    }
  }
  // A sample of 30 000, five visits apart, has a standard deviation below .006.
  for (const auto& [partition, share] : expected) EXPECT_NEAR(seen[partition], share, 0.02);
  EXPECT_EQ(seen.size(), 4u);
}

// Accuracy when each topic is given its majority class, and how many topics there are.
struct Recovered {
  double accuracy = 0;
  size_t num_topics = 0;
};
Recovered recover(const CellLabelHyperparameters& h, uint64_t seed, int32_t num_classes) {
  CellLabelModel model(h, PlantedMap::groups(), seed, RobotId{0});
  PlantedMap map(100 + seed, num_classes);
  for (int32_t i = 0; i + 1 < PlantedMap::kSide; ++i) model.observe(map.image(i));
  const Snapshot snapshot = model.snapshot();
  std::map<int32_t, std::map<int32_t, int>> classes;
  for (const CellLabel& c : snapshot.cells) ++classes[number(c.topic)][map.classOf(c.cell)];
  int right = 0;
  for (const auto& [topic, count] : classes) {
    right += std::ranges::max_element(count, {}, [](const auto& c) { return c.second; })->second;
  }
  return {static_cast<double>(right) / static_cast<double>(snapshot.cells.size()), snapshot.topics.size()};
}

TEST(CellLabelModelTest, RecoversPlantedTopics) {
  for (const int32_t num_classes : {3, 5}) {
    std::vector<double> accuracy;
    for (uint64_t seed = 1; seed <= 7; ++seed) {
      const Recovered r = recover({}, seed, num_classes);
      accuracy.push_back(r.accuracy);
      EXPECT_GE(r.num_topics, static_cast<size_t>(num_classes));
    }
    std::ranges::sort(accuracy);
    EXPECT_GT(accuracy[3], 0.98) << "median, " << num_classes << " classes";
    EXPECT_GT(accuracy[0], 0.93) << "worst, " << num_classes << " classes";
  }
}

// The first cell finds empty labels and chance: 1 / 3 each. Its neighbour then sees one label with a word
// like its own, (1 + 1) / (1 + 3), and chance where that is its own label, or an empty one, 1 / 3, against
// it.
TEST(CellLabelModelTest, CertaintyComesFromTheBestTopics) {
  const auto chance = -static_cast<int64_t>(fixedLog2(3));
  const auto certainty = [&](int64_t own, int64_t other) { return cellCertainty(own, other, 1, -chance); };
  for (uint64_t seed = 0; seed < 20; ++seed) {
    CellLabelModel model({.max_topics = 3, .cells_per_topic = 1, .evidence = 0.5, .beta = 1, .coupling = 0.7},
                         kThreeWords, seed, RobotId{0});
    model.add(image(0, {{{9, 0, 0}, {{0, 1}}}}));
    EXPECT_NEAR(model.snapshot().cells[0].certainty, certainty(chance, chance), 1e-4);
    model.add(image(1, {{{9, 1, 0}, {{0, 1}}}}));
    const std::vector<CellLabel> cells = model.snapshot().cells;
    const bool agree = cells[0].topic == cells[1].topic;
    EXPECT_NEAR(cells[1].certainty, agree ? certainty(-kLogOne, chance) : certainty(chance, -kLogOne), 1e-4);
  }
}

TEST(CellLabelModelTest, NeighborsDecideWhatWordsLeaveOpen) {
  for (const double coupling : {0.0, 3.0}) {
    int agreements = 0;
    for (uint64_t seed = 0; seed < 40; ++seed) {
      CellLabelModel model({.max_topics = 2, .evidence = 100, .beta = 1, .coupling = coupling}, kThreeWords,
                           seed, RobotId{0});
      // Word 2 is as common in both; cell (0,0,0) has one of it and adjoins (-1,0,0) only.
      model.add(image(
          0, {{{-1, 0, 0}, {{0, 30}, {2, 30}}}, {{0, 0, 0}, {{2, 1}}}, {{9, 0, 0}, {{1, 30}, {2, 30}}}}));
      model.refine(100);
      const Snapshot snapshot = model.snapshot();
      agreements += snapshot.cells[0].topic == snapshot.cells[1].topic;
    }
    if (coupling > 0) {
      EXPECT_GE(agreements, 34);  // odds of 20 to 1
    } else {
      EXPECT_LE(agreements, 32);  // even odds
    }
  }
}

// At most one topic for every 10 cells seen, but two; never more than 6.
TEST(CellLabelModelTest, TheNumberOfTopicsIsTiedToWhatWasSeen) {
  CellLabelModel model({.max_topics = 6, .cells_per_topic = 10, .evidence = 1, .twin_similarity = 1},
                       PlantedMap::groups(), 1, RobotId{0});
  PlantedMap map(5, 3);
  EXPECT_EQ(model.topicLimit(), 2);
  int32_t most = 0;
  for (int32_t i = 0; i < 10; ++i) {
    const WordsInCells whole = map.image(i);
    for (size_t half = 0; half < 2; ++half) {
      WordsInCells part = whole;
      part.observation = 2 * i + static_cast<int32_t>(half);
      part.cells = {whole.cells.begin() + static_cast<ptrdiff_t>(24 * half),
                    whole.cells.begin() + static_cast<ptrdiff_t>(24 * half + 24)};
      model.observe(part);
      EXPECT_EQ(model.topicLimit(), std::clamp(model.numCells() / 10, 2, 6));
      EXPECT_LE(model.numTopics(), model.topicLimit());
      most = std::max(most, model.numTopics());
    }
  }
  EXPECT_EQ(most, 6);  // nearly even odds fill all there are
}

// Many labels over three classes cut classes in pieces. With twins joined fewer topics are told; the labels
// themselves are the same.
TEST(CellLabelModelTest, TellsTwinsAsOneTopic) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    CellLabelHyperparameters apart{.max_topics = 16, .evidence = 3, .twin_similarity = 1}, joined = apart;
    joined.twin_similarity = 0.3;
    CellLabelModel pieces(apart, PlantedMap::groups(), seed, RobotId{0});
    CellLabelModel whole(joined, PlantedMap::groups(), seed, RobotId{0});
    PlantedMap map(100 + seed, 3), same(100 + seed, 3);
    for (int32_t i = 0; i < 20; ++i) {
      pieces.observe(map.image(i));
      whole.observe(same.image(i));
    }
    const Snapshot fine = pieces.snapshot(), coarse = whole.snapshot();
    EXPECT_GE(coarse.topics.size(), 3u);
    EXPECT_LE(coarse.topics.size(), fine.topics.size() / 2);
    ASSERT_EQ(fine.cells.size(), coarse.cells.size());
    const auto drawn = pieces.drawnTopics(), drawn_as = whole.drawnTopics();
    std::map<int32_t, int32_t> told;  // a piece's topic
    for (size_t c = 0; c < fine.cells.size(); ++c) {
      const int32_t as = number(drawn_as[c]);
      EXPECT_EQ(told.emplace(number(drawn[c]), as).first->second, as);
    }
    double sure_of_pieces = 0, sure_of_wholes = 0;
    for (const CellLabel& cell : fine.cells) sure_of_pieces += double{cell.certainty};
    for (const CellLabel& cell : coarse.cells) sure_of_wholes += double{cell.certainty};
    EXPECT_GT(sure_of_wholes, sure_of_pieces);
    std::map<int32_t, int64_t> weight;
    std::map<int32_t, int32_t> oldest;
    for (const TopicCounts& piece : fine.topics) {
      const int32_t as = told.at(number(piece.id));
      weight[as] += piece.weight;
      oldest.emplace(as, number(piece.id));  // ids ascend
    }
    for (const TopicCounts& topic : coarse.topics) {
      EXPECT_EQ(topic.weight, weight.at(number(topic.id)));
      EXPECT_EQ(number(topic.id), oldest.at(number(topic.id)));
    }
  }
}

// Share of the cells whose topic has their class as its majority.
double accuracy(const Snapshot& snapshot, const std::vector<world::TopicId>& topics, const PlantedMap& map) {
  std::map<int32_t, std::map<int32_t, int>> classes;
  for (size_t c = 0; c < topics.size(); ++c)
    ++classes[number(topics[c])][map.classOf(snapshot.cells[c].cell)];
  int right = 0;
  for (const auto& [topic, count] : classes)
    right += std::ranges::max_element(count, {}, [](const auto& c) { return c.second; })->second;
  return static_cast<double>(right) / static_cast<double>(topics.size());
}

// Labels drawn softly are a sample of what might be; the likeliest are right more often, with every seed.
TEST(CellLabelModelTest, TellsTheLikeliestLabelAndNotTheOneDrawn) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    CellLabelModel model({.max_topics = 16, .evidence = 3, .twin_similarity = 0.3}, PlantedMap::groups(),
                         seed, RobotId{0});
    PlantedMap map(100 + seed, 3);
    for (int32_t i = 0; i + 1 < PlantedMap::kSide; ++i) model.observe(map.image(i));
    const Snapshot snapshot = model.snapshot();
    std::vector<world::TopicId> told;
    for (const CellLabel& cell : snapshot.cells) told.push_back(cell.topic);
    EXPECT_GT(accuracy(snapshot, told, map), accuracy(snapshot, model.drawnTopics(), map)) << seed;
  }
}

// With hardly any likelihood labels die and open all the time. An id names one topic for ever: once it is
// gone it never returns, it keeps its creation time, and a younger topic has a larger id.
TEST(CellLabelModelTest, IdsAreNeverUsedAgain) {
  CellLabelModel model(
      {.max_topics = 30, .cells_per_topic = 1, .evidence = 0.1, .coupling = 0, .twin_similarity = 1},
      PlantedMap::groups(), 1, RobotId{0});
  PlantedMap map(5, 3);
  std::map<int32_t, int64_t> created;
  std::set<int32_t> gone, alive;
  for (int32_t i = 0; i < 23; ++i) {
    WordsInCells words = map.image(i);
    words.cells.resize(4);
    model.observe(words);
    std::set<int32_t> now;
    int64_t last_created = 0;
    for (const TopicCounts& topic : model.snapshot().topics) {
      const int32_t id = number(topic.id);
      now.insert(id);
      EXPECT_FALSE(gone.contains(id));
      EXPECT_EQ(created.try_emplace(id, topic.created.us).first->second, topic.created.us);
      EXPECT_GE(topic.created.us, last_created);
      last_created = topic.created.us;
      if (!alive.contains(id)) {
        EXPECT_EQ(topic.created.us, i * 1'000'000LL);
      }
    }
    for (const int32_t id : alive) {
      if (!now.contains(id)) gone.insert(id);
    }
    alive = now;
  }
  EXPECT_GT(gone.size(), 5u);  // else nothing was tried
}

// Ids run out at 10 000; the model goes on with the topics it has.
TEST(CellLabelModelTest, GoesOnWhenTheIdsHaveRunOut) {
  CellLabelModel model({.max_topics = 40, .cells_per_topic = 1, .evidence = 1e-3, .coupling = 0}, kThreeWords,
                       1, RobotId{0});
  std::vector<CellWords> cells;
  for (int32_t x = 0; x < 40; ++x) cells.push_back({{2 * x, 0, 0}, {{x % 3, 1}}});
  model.add(image(0, cells));
  int32_t highest = 0;
  for (int i = 0; i < 3000; ++i) {
    model.refine(40);
    highest = number(model.snapshot().topics.back().id);
  }
  EXPECT_LE(highest, world::kMaxTopicId);
  EXPECT_GT(highest, world::kMaxTopicId - 40);
  EXPECT_GE(model.numTopics(), 1);
}

TEST(CellLabelModelTest, EqualInputsGiveEqualBytes) {
  EXPECT_EQ(mission({}, 7, RobotId{3}), mission({}, 7, RobotId{3}));
}

TEST(CellLabelModelTest, SeedRobotAndEveryHyperparameterMatter) {
  const std::string base = mission({}, 7, RobotId{3});
  EXPECT_NE(mission({}, 8, RobotId{3}), base);
  EXPECT_NE(mission({}, 7, RobotId{4}), base);
  std::vector<CellLabelHyperparameters> others(9);
  others[0].max_topics = 7;
  others[1].cells_per_topic = 60;
  others[2].evidence = 20;
  others[3].beta = 0.5;
  others[4].coupling = 0.2;
  others[5].tau = 0.9;
  others[6].local_rate = 0.6;
  others[7].visits_per_cell = 3;
  others[8].twin_similarity = 0.2;
  for (size_t i = 0; i < others.size(); ++i) EXPECT_NE(mission(others[i], 7, RobotId{3}), base) << i;
}

// The same digest from every compiler and at every optimisation level: the sanitizer and the release builds
// run this one test. It changes when the sampler's draws change, which is then a deliberate act.
TEST(CellLabelModelTest, EveryBuildGivesTheSameBytes) {
  const CellLabelHyperparameters h{.max_topics = 11,
                                   .cells_per_topic = 20,
                                   .evidence = 7.5,
                                   .beta = 0.75,
                                   .coupling = 1.1,
                                   .tau = 1.0,
                                   .local_rate = 0.4,
                                   .visits_per_cell = 3};
  uint64_t digest = 0;
  for (const char c : mission(h, 1, RobotId{12}, 20)) digest = hashCombine(digest, static_cast<uint8_t>(c));
  EXPECT_EQ(digest, 11865385265646555397u);
}

// Other models, snapshots and copies in between leave a model's numbers alone.
TEST(CellLabelModelTest, TheResultDependsOnNothingElse) {
  CellLabelModel model({}, PlantedMap::groups(), 7, RobotId{3});
  CellLabelModel other({}, PlantedMap::groups(), 9, RobotId{1});
  PlantedMap map(3, 4), elsewhere(4, 3);
  for (int32_t i = 0; i < 12; ++i) {
    other.observe(elsewhere.image(i));
    const WordsInCells words = map.image(i);
    CellLabelModel fork = model;
    fork.observe(words);
    model.observe(words);
    EXPECT_EQ(dump(fork.snapshot()), dump(model.snapshot()));
  }
  EXPECT_EQ(dump(model.snapshot()), mission({}, 7, RobotId{3}));
}

// The budget is a count of visits: twice the cells of the image, and none for an image without words.
TEST(CellLabelModelTest, TheWorkOfAnImageIsACount) {
  CellLabelModel model({.visits_per_cell = 2.5}, PlantedMap::groups(), 7, RobotId{3});
  PlantedMap map(3, 4);
  model.observe(map.image(0));
  EXPECT_EQ(model.numVisits(), 120);  // 2.5 x 48
  model.observe(map.image(1));
  EXPECT_EQ(model.numVisits(), 240);
  model.observe(image(2, {}));
  EXPECT_EQ(model.numVisits(), 240);
  model.refine(7);
  EXPECT_EQ(model.numVisits(), 247);
}

TEST(CellLabelModelTest, ARevisitAppendsToItsCell) {
  CellLabelModel model({}, kThreeWords, 1, RobotId{0});
  model.observe(image(0, {{{-3, 2, 1}, {{1, 2}}}}));
  model.observe(image(1, {{{-3, 2, 1}, {{0, 4}, {1, 3}, {2, 1}}}}));
  const Snapshot snapshot = model.snapshot();
  EXPECT_EQ(model.numCells(), 1);
  EXPECT_EQ(snapshot.cells[0].seen_observation, 1);
  ASSERT_EQ(snapshot.topics.size(), 1u);
  EXPECT_EQ(snapshot.topics[0].words, (std::vector<world::WordCount>{{0, 4}, {1, 5}, {2, 1}}));
}

TEST(CellLabelModelTest, RejectsBadInputAndStaysAsItWas) {
  CellLabelModel model({}, PlantedMap::groups(), 7, RobotId{3});
  PlantedMap map(3, 4);
  for (int32_t i = 0; i < 12; ++i) model.observe(map.image(i));
  EXPECT_THROW(model.observe(image(11, {})), std::invalid_argument);  // an old image
  EXPECT_THROW(model.observe(image(12, {{{0, 0, 0}, {{0, 1}}}, {{9, 9, 9}, {{100, 1}}}})),
               std::invalid_argument);
  EXPECT_THROW(model.refine(-1), std::invalid_argument);
  EXPECT_EQ(dump(model.snapshot()), mission({}, 7, RobotId{3}));
  model.observe(map.image(12));
  EXPECT_EQ(dump(model.snapshot()), mission({}, 7, RobotId{3}, 13));
}

}  // namespace
}  // namespace shoal::topics
