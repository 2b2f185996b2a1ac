// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/topic_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "shoal/random.h"

namespace shoal::topics {
namespace {

using world::CellIndex;
using world::CellWords;
using world::RobotId;
using world::Timestamp;
using world::WordsInCells;

constexpr int32_t kVocabulary = 60;

WordsInCells image(int32_t observation, std::vector<CellWords> cells) {
  return {
      .observation = observation, .time = Timestamp{observation * 1'000'000LL}, .cells = std::move(cells)};
}

// A strip of ground, four cells wide, flown westwards from x = 9, across the origin. Terrain changes every 4
// cells along the way; each of its `num_classes` classes has words of its own, and one word in five comes
// from anywhere.
class Strip {
 public:
  Strip(uint64_t seed, int32_t num_classes) : random_(seed), num_classes_(num_classes) {}

  int32_t classOf(const CellIndex& cell) const { return ((cell.x + 1000) / 4 + cell.y / 2) % num_classes_; }

  // Two new columns of cells, and the last one again.
  WordsInCells fly(int32_t observation) {
    std::vector<CellWords> cells;
    const int32_t x = 8 - 2 * observation;
    for (int32_t column = x; column < std::min(x + 3, 10); ++column) {
      for (int32_t y = 0; y < 4; ++y) {
        CellWords& cell = cells.emplace_back(CellWords{{column, y, 0}, {}});
        std::map<int32_t, int32_t> counts;
        for (int i = 0; i < 20; ++i) ++counts[word(classOf(cell.cell))];
        for (const auto& [word, count] : counts) cell.words.push_back({word, count});
      }
    }
    return image(observation, std::move(cells));
  }

 private:
  int32_t word(int32_t terrain) {
    if (random_.uniform() < 0.2) return static_cast<int32_t>(random_.below(kVocabulary));
    const int32_t size = kVocabulary / num_classes_;
    return terrain * size + static_cast<int32_t>(random_.below(static_cast<uint64_t>(size)));
  }

  Random random_;
  int32_t num_classes_;
};

// Normalised mutual information 2 I / (H + H) of two labelings, in [0, 1].
double mutualInformation(const std::vector<std::pair<int32_t, int32_t>>& labels) {
  std::map<std::pair<int32_t, int32_t>, double> joint;
  std::map<int32_t, double> a, b;
  for (const auto& [i, j] : labels) {
    const double share = 1.0 / static_cast<double>(labels.size());
    joint[{i, j}] += share;
    a[i] += share;
    b[j] += share;
  }
  double information = 0, entropy = 0;
  for (const auto& [ij, p] : joint) information += p * std::log(p / (a[ij.first] * b[ij.second]));
  for (const auto& marginal : {a, b}) {
    for (const auto& [i, p] : marginal) entropy -= p * std::log(p);
  }
  return 2.0 * information / entropy;
}

// Everything a snapshot says, as text with exact floats: equal iff the bytes are.
std::string dump(const Snapshot& s) {
  std::string out = std::to_string(s.vocabulary_size);
  for (const TopicCounts& t : s.topics) {
    out += "\nt" + std::to_string(number(t.id)) + ' ' + std::to_string(t.created.us) + ' ' +
           std::to_string(t.weight);
    for (const auto& [word, count] : t.words) out += ' ' + std::to_string(word) + ':' + std::to_string(count);
  }
  for (const CellLabel& c : s.cells) {
    uint32_t bits = 0;
    std::memcpy(&bits, &c.certainty, sizeof bits);
    for (const int64_t value :
         {int64_t{c.cell.x}, int64_t{c.cell.y}, int64_t{c.cell.z}, int64_t{number(c.topic)}, int64_t{bits},
          int64_t{c.seen_observation}, c.seen.us}) {
      out += (value == c.cell.x ? "\n" : " ") + std::to_string(value);
    }
  }
  return out;
}

std::string mission(const Hyperparameters& h, uint64_t seed, RobotId robot, int32_t num_images = 8) {
  TopicModel model(h, kVocabulary, seed, robot);
  Strip strip(3, 3);
  for (int32_t i = 0; i < num_images; ++i) model.observe(strip.fly(i));
  return dump(model.snapshot());
}

const Hyperparameters kQuick{.max_topics = 8, .beta = 0.42, .resamples_per_observation = 2000};

TEST(TopicModelTest, KnowsNothingBeforeTheFirstImage) {
  TopicModel model({}, kVocabulary, 1, RobotId{0});
  model.refine(1000);
  const Snapshot snapshot = model.snapshot();
  EXPECT_EQ(snapshot.vocabulary_size, kVocabulary);
  EXPECT_TRUE(snapshot.topics.empty());
  EXPECT_TRUE(snapshot.cells.empty());
}

// What a snapshot promises, checked on a real mission against the words that went in.
TEST(TopicModelTest, SnapshotsHoldEveryWordAndCellOnceInOrder) {
  for (const double gamma : {0.0, 0.05}) {
    TopicModel model({.max_topics = 8, .beta = 0.42, .gamma = gamma, .resamples_per_observation = 2000},
                     kVocabulary, 1, RobotId{0});
    Strip strip(5, 3);
    std::map<int32_t, int64_t> words_in;
    std::map<CellIndex, int32_t> seen;
    for (int32_t i = 0; i < 10; ++i) {
      const WordsInCells words = strip.fly(i);
      for (const CellWords& cell : words.cells) {
        seen[cell.cell] = i;
        for (const auto& [word, count] : cell.words) words_in[word] += count;
      }
      model.observe(words);
      const Snapshot snapshot = model.snapshot();

      std::map<int32_t, int64_t> words_out;
      std::set<int32_t> ids;
      int32_t last_id = -1;
      for (const TopicCounts& topic : snapshot.topics) {
        EXPECT_GT(number(topic.id), last_id);
        last_id = number(topic.id);
        ids.insert(last_id);
        int64_t weight = 0;
        int32_t last_word = -1;
        for (const auto& [word, count] : topic.words) {
          EXPECT_GT(word, last_word);
          EXPECT_GT(count, 0);
          last_word = word;
          weight += count;
          words_out[word] += count;
        }
        EXPECT_EQ(topic.weight, weight);
        EXPECT_GT(topic.weight, 0);
      }
      EXPECT_EQ(words_out, words_in);
      EXPECT_EQ(static_cast<int32_t>(snapshot.topics.size()), model.numTopics());

      ASSERT_EQ(snapshot.cells.size(), seen.size());
      auto expected = seen.begin();
      for (const CellLabel& label : snapshot.cells) {
        EXPECT_EQ(label.cell, expected->first);
        EXPECT_EQ(label.seen_observation, expected->second);
        EXPECT_EQ(label.seen.us, expected->second * 1'000'000LL);
        EXPECT_TRUE(ids.contains(number(label.topic)));
        EXPECT_GT(label.certainty, 0.0F);
        EXPECT_LE(label.certainty, 1.0F);
        ++expected;
      }
    }
  }
}

// With one topic there is nothing to draw: every figure can be worked out by hand.
TEST(TopicModelTest, ASingleTopicIsWorkedByHand) {
  TopicModel model({.max_topics = 1}, 5, 1, RobotId{0});
  model.observe(image(4, {{{-1, 0, 0}, {{0, 2}, {3, 1}}}, {{0, 0, 0}, {{3, 4}}}}));
  const Snapshot snapshot = model.snapshot();
  ASSERT_EQ(snapshot.topics.size(), 1u);
  EXPECT_EQ(number(snapshot.topics[0].id), 0);
  EXPECT_EQ(snapshot.topics[0].created.us, 4'000'000);
  EXPECT_EQ(snapshot.topics[0].weight, 7);
  EXPECT_EQ(snapshot.topics[0].words, (std::vector<world::WordCount>{{0, 2}, {3, 5}}));
  ASSERT_EQ(snapshot.cells.size(), 2u);
  EXPECT_EQ(snapshot.cells[0].certainty, 1.0F);
}

// One word a cell and topics that cannot agree (beta tiny): each word is its own topic. Then the certainty of
// the middle cell is (1 + alpha) / (1 + .5 + .5 + 3 alpha), of an end (1 + alpha) / (1 + .5 + 3 alpha).
TEST(TopicModelTest, CertaintyIsTheShareOfTheNeighborhoodPosterior) {
  TopicModel model({.max_topics = 3, .alpha = 1.0, .beta = 1e-9}, 3, 4, RobotId{0});
  model.add(image(0, {{{0, 0, 0}, {{0, 50}}}, {{1, 0, 0}, {{1, 50}}}, {{2, 0, 0}, {{2, 50}}}}));
  model.refine(10'000);
  const Snapshot snapshot = model.snapshot();
  ASSERT_EQ(snapshot.topics.size(), 3u);
  for (const TopicCounts& topic : snapshot.topics) ASSERT_EQ(topic.words.size(), 1u);
  EXPECT_FLOAT_EQ(snapshot.cells[0].certainty, 51.0F / 78.0F);
  EXPECT_FLOAT_EQ(snapshot.cells[1].certainty, 51.0F / 103.0F);
}

// K counts in the certainty: (1 + alpha) / (1 + 4 alpha) with four topics that any word may take, 1 when one
// topic is all there is.
TEST(TopicModelTest, CertaintyCountsTheTopicsThatCouldHaveBeen) {
  for (const double gamma : {0.0, 1e-20}) {
    TopicModel model({.max_topics = 4, .alpha = 0.5, .gamma = gamma}, 3, 1, RobotId{0});
    model.add(image(0, {{{0, 0, 0}, {{0, 1}}}}));
    EXPECT_FLOAT_EQ(model.snapshot().cells[0].certainty, gamma == 0.0 ? 1.5F / 3.0F : 1.0F);
  }
}

// In a world of one cell n_ck is the weight of topic k, which snapshots show. Ids and slots soon differ in
// order, and ties are common.
TEST(TopicModelTest, TheLabelIsTheTopicOfMostWordsOrTheOldestOfThem) {
  TopicModel model({.max_topics = 4, .alpha = 5.0, .gamma = 1.0, .resamples_per_observation = 6}, 3, 1,
                   RobotId{0});
  model.add(image(0, {{{0, 0, 0}, {{0, 2}, {1, 2}, {2, 2}}}}));
  int num_ties = 0;
  for (int32_t i = 1; i < 2000; ++i) {
    model.observe(image(i, {}));
    const Snapshot snapshot = model.snapshot();
    const auto largest =
        std::ranges::max_element(snapshot.topics, {}, &TopicCounts::weight);  // the first of them
    EXPECT_EQ(snapshot.cells[0].topic, largest->id);
    num_ties += std::ranges::count(snapshot.topics, largest->weight, &TopicCounts::weight) > 1;
  }
  EXPECT_GT(num_ties, 100);
}

// Neighbours sway a cell that its own words leave open, also across the origin into negative coordinates.
TEST(TopicModelTest, NeighborsDecideWhatWordsLeaveOpen) {
  for (const double weight : {0.0, 1.0}) {
    int agreements = 0;
    for (uint64_t seed = 0; seed < 40; ++seed) {
      TopicModel model({.max_topics = 2, .alpha = 0.01, .beta = 0.1, .neighbor_weight = weight}, 3, seed,
                       RobotId{0});
      // Word 2 alone is ambiguous; cell (0,0,0) has two of it and adjoins (-1,0,0) only.
      model.add(image(0, {{{-1, 0, 0}, {{0, 30}}},
                          {{0, 0, 0}, {{2, 2}}},
                          {{9, 0, 0}, {{1, 30}}},
                          {{9, 1, 0}, {{2, 30}}},
                          {{9, 3, 0}, {{0, 30}}},
                          {{9, 4, 0}, {{2, 30}}}}));
      model.refine(20'000);
      const Snapshot snapshot = model.snapshot();
      agreements += snapshot.cells[0].topic == snapshot.cells[1].topic;
    }
    if (weight == 1.0) {
      EXPECT_GE(agreements, 36);
    } else {
      EXPECT_LE(agreements, 32);
    }
  }
}

// Planted terrain comes back, with fixed K and with growing K, whatever the seed.
TEST(TopicModelTest, RecoversPlantedTopics) {
  for (const double gamma : {0.0, 0.1}) {
    std::vector<double> scores;
    for (uint64_t seed = 1; seed <= 7; ++seed) {
      const int32_t num_classes = 4;
      TopicModel model({.max_topics = gamma == 0.0 ? num_classes : 12,
                        .gamma = gamma,
                        .resamples_per_observation = 10'000},
                       kVocabulary, seed, RobotId{0});
      Strip strip(100 + seed, num_classes);
      for (int32_t i = 0; i < 24; ++i) model.observe(strip.fly(i));
      std::vector<std::pair<int32_t, int32_t>> labels;
      for (const CellLabel& label : model.snapshot().cells) {
        labels.emplace_back(number(label.topic), strip.classOf(label.cell));
      }
      scores.push_back(mutualInformation(labels));
    }
    std::ranges::sort(scores);
    EXPECT_GT(scores[3], 0.9) << "median, gamma " << gamma;  // a chain may merge two classes: not every seed
    EXPECT_GT(scores[0], 0.7) << "worst, gamma " << gamma;
  }
}

TEST(TopicModelTest, ATinyGammaNeverOpensASecondTopic) {
  TopicModel model({.gamma = 1e-20, .resamples_per_observation = 5000}, kVocabulary, 1, RobotId{0});
  Strip strip(1, 3);
  for (int32_t i = 0; i < 10; ++i) model.observe(strip.fly(i));
  EXPECT_EQ(model.numTopics(), 1);
}

TEST(TopicModelTest, AModerateGammaOpensTopicsAsTheyAreSeen) {
  TopicModel model({.gamma = 0.1, .resamples_per_observation = 5000}, kVocabulary, 1, RobotId{0});
  Strip strip(1, 3);
  for (int32_t i = 0; i < 20; ++i) model.observe(strip.fly(i));
  EXPECT_GE(model.numTopics(), 3);
}

TEST(TopicModelTest, AZeroGammaNeedsNoNewTopicRule) {
  TopicModel model({.max_topics = 8, .beta = 0.42, .resamples_per_observation = 0}, kVocabulary, 1,
                   RobotId{0});
  Strip strip(1, 3);
  model.observe(strip.fly(0));
  EXPECT_GE(model.numTopics(), 4);
}

// A large gamma lets topics die and open all the time. An id names one topic for ever: once it is gone it
// never returns, it keeps its creation time, and a younger topic has a larger id.
TEST(TopicModelTest, IdsAreNeverUsedAgain) {
  size_t num_gone = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    TopicModel model({.max_topics = 20, .beta = 0.42, .gamma = 10.0, .resamples_per_observation = 2000},
                     kVocabulary, seed, RobotId{0});
    Strip strip(1, 3);
    std::map<int32_t, int64_t> created;
    std::set<int32_t> gone;
    std::set<int32_t> alive;
    for (int32_t i = 0; i < 30; ++i) {
      model.observe(strip.fly(i));
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
    num_gone += gone.size();
  }
  EXPECT_GT(num_gone, 5u);  // else nothing was tried
}

TEST(TopicModelTest, EqualInputsGiveEqualBytes) {
  for (const double gamma : {0.0, 0.05}) {
    Hyperparameters h = kQuick;
    h.gamma = gamma;
    EXPECT_EQ(mission(h, 7, RobotId{3}), mission(h, 7, RobotId{3}));
  }
}

TEST(TopicModelTest, SeedRobotAndEveryHyperparameterMatter) {
  const std::string base = mission(kQuick, 7, RobotId{3});
  EXPECT_NE(mission(kQuick, 8, RobotId{3}), base);
  EXPECT_NE(mission(kQuick, 7, RobotId{4}), base);
  std::vector<Hyperparameters> others(8, kQuick);
  others[0].max_topics = 7;
  others[1].alpha = 0.2;
  others[2].beta = 0.2;
  others[3].gamma = 0.2;
  others[4].neighbor_weight = 0.2;
  others[5].tau = 0.9;
  others[6].local_rate = 0.2;
  others[7].resamples_per_observation = 3000;
  for (size_t i = 0; i < others.size(); ++i) EXPECT_NE(mission(others[i], 7, RobotId{3}), base) << i;
}

// The same digest from every compiler and at every optimisation level: the sanitizer and the release builds
// run this one test. It changes when the sampler's draws change, which is then a deliberate act.
TEST(TopicModelTest, EveryBuildGivesTheSameBytes) {
  Hyperparameters h = kQuick;
  h.gamma = 0.1;
  h.max_topics = 11;
  h.tau = 1.0;
  uint64_t digest = 0;
  for (const char c : mission(h, 1, RobotId{12}, 20)) digest = hashCombine(digest, static_cast<uint8_t>(c));
  EXPECT_EQ(digest, 7717381742002633542u);
}

// Also without a single scheduled visit: the draws of new words have numbers of their own.
TEST(TopicModelTest, SeedAndRobotMatterFromTheFirstWord) {
  Hyperparameters h = kQuick;
  h.resamples_per_observation = 0;
  EXPECT_NE(mission(h, 8, RobotId{3}), mission(h, 7, RobotId{3}));
  EXPECT_NE(mission(h, 7, RobotId{4}), mission(h, 7, RobotId{3}));
}

// Other models, snapshots and copies in between leave a model's numbers alone.
TEST(TopicModelTest, TheResultDependsOnNothingElse) {
  TopicModel model(kQuick, kVocabulary, 7, RobotId{3});
  TopicModel other(kQuick, kVocabulary, 9, RobotId{1});
  Strip strip(3, 3), elsewhere(4, 3);
  for (int32_t i = 0; i < 8; ++i) {
    other.observe(elsewhere.fly(i));
    const WordsInCells words = strip.fly(i);
    TopicModel fork = model;
    fork.observe(words);
    model.observe(words);
    EXPECT_EQ(dump(fork.snapshot()), dump(model.snapshot()));
  }
  EXPECT_EQ(dump(model.snapshot()), mission(kQuick, 7, RobotId{3}));
}

TEST(TopicModelTest, ObservingIsAddingThenRefining) {
  TopicModel model(kQuick, kVocabulary, 7, RobotId{3});
  Strip strip(3, 3);
  for (int32_t i = 0; i < 8; ++i) {
    model.add(strip.fly(i));
    model.refine(kQuick.resamples_per_observation);
  }
  EXPECT_EQ(dump(model.snapshot()), mission(kQuick, 7, RobotId{3}));
}

// The budget is a count of words, exact to the last cell however it is cut up.
TEST(TopicModelTest, SpendsTheBudgetToTheLastCell) {
  TopicModel model(kQuick, kVocabulary, 7, RobotId{3});
  Strip strip(3, 3);
  model.add(strip.fly(0));
  const int64_t added = model.numResamples();
  EXPECT_EQ(added, 8 * 20);  // each of the 8 new cells visited once
  for (int i = 0; i < 100; ++i) model.refine(33);
  EXPECT_GE(model.numResamples() - added, 3300);
  EXPECT_LT(model.numResamples() - added, 3300 + 20);
}

// The cells have 10, 20 and 40 words, so the count tells which was visited.
TEST(TopicModelTest, LocalVisitsStayInTheLatestImage) {
  TopicModel model({.local_rate = 1.0}, 5, 1, RobotId{0});
  model.add(image(0, {{{0, 0, 0}, {{0, 10}}}}));
  model.add(image(1, {{{1, 0, 0}, {{0, 20}}}, {{2, 0, 0}, {{1, 40}}}}));
  model.refine(1);  // from here on an overrun is owed; 100 covers it
  for (int i = 0; i < 50; ++i) {
    const int64_t before = model.numResamples();
    model.refine(100);
    EXPECT_EQ((model.numResamples() - before) % 20, 0);
  }
}

TEST(TopicModelTest, AnImageWithoutWordsRefinesThePast) {
  TopicModel model(kQuick, kVocabulary, 7, RobotId{3});
  Strip strip(3, 3);
  model.observe(strip.fly(0));
  const Snapshot before = model.snapshot();
  const int64_t resamples = model.numResamples();
  model.observe(image(1, {}));
  const Snapshot after = model.snapshot();
  EXPECT_GE(model.numResamples(), resamples + 2000 - 20);
  ASSERT_EQ(after.cells.size(), before.cells.size());
  for (const CellLabel& label : after.cells) EXPECT_EQ(label.seen_observation, 0);
}

TEST(TopicModelTest, ARevisitAppendsToItsCell) {
  TopicModel model({.max_topics = 1}, 5, 1, RobotId{0});
  model.observe(image(0, {{{-3, 2, 1}, {{1, 2}}}}));
  model.observe(image(1, {{{-3, 2, 1}, {{1, 3}, {4, 1}}}}));
  const Snapshot snapshot = model.snapshot();
  EXPECT_EQ(model.numCells(), 1);
  EXPECT_EQ(snapshot.cells[0].seen_observation, 1);
  EXPECT_EQ(snapshot.topics[0].words, (std::vector<world::WordCount>{{1, 5}, {4, 1}}));
}

TEST(TopicModelTest, WorksAtTheEndsOfTheWorld) {
  const int32_t low = std::numeric_limits<int32_t>::min(), high = std::numeric_limits<int32_t>::max();
  TopicModel model(kQuick, 5, 1, RobotId{0});
  model.observe(image(0, {{{low, low, low}, {{1, 2}}}, {{high, high, high}, {{1, 3}}}}));
  EXPECT_EQ(model.numCells(), 2);
}

TEST(TopicModelTest, RejectsBadInputAndStaysAsItWas) {
  TopicModel model(kQuick, kVocabulary, 7, RobotId{3});
  Strip strip(3, 3);
  for (int32_t i = 0; i < 8; ++i) model.observe(strip.fly(i));
  EXPECT_THROW(model.observe(image(7, {})), std::invalid_argument);  // an old image
  EXPECT_THROW(model.observe(image(8, {{{0, 0, 0}, {{0, 1}}}, {{9, 9, 9}, {{kVocabulary, 1}}}})),
               std::invalid_argument);
  EXPECT_THROW(model.refine(-1), std::invalid_argument);
  EXPECT_EQ(dump(model.snapshot()), mission(kQuick, 7, RobotId{3}));
  model.observe(strip.fly(8));
  EXPECT_EQ(dump(model.snapshot()), mission(kQuick, 7, RobotId{3}, 9));
}

TEST(TopicModelTest, RejectsBadHyperparameters) {
  EXPECT_THROW(TopicModel({.max_topics = 0}, 5, 1, RobotId{0}), std::invalid_argument);
  EXPECT_THROW(TopicModel({}, 0, 1, RobotId{0}), std::invalid_argument);
}

}  // namespace
}  // namespace shoal::topics
