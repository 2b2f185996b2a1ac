// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/belief_pieces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <vector>

#include "shoal/mapping/belief_store.h"
#include "shoal/random.h"

namespace shoal::mapping {
namespace {

LocalBelief belief(int observation) {
  return {
      .robot = world::RobotId{2},
      .version = {0, observation},
      .groups = {{"a", 0, 10}},
      .topics = {{world::TopicId{0}, {0}, 30, {{1, 30}}}, {world::TopicId{4}, {5}, 20, {{2, 20}}}},
      .cells = {{{-1, 0, 0}, world::TopicId{0}, {1000}, 0.5f}, {{0, 0, 0}, world::TopicId{4}, {1000}, 1.f}}};
}

TEST(QuantizeTest, LeavesSmallCountsExact) {
  EXPECT_EQ(quantize({{0, 3}, {9, 4}}), (std::vector<world::WordCount>{{0, 3}, {9, 4}}));  // norm 5
}

TEST(QuantizeTest, RoundsToAThousandthOfTheNorm) {
  // Norm of (3000, 4000) is 5000, the step 5: 600 and 800. 12 / 5 rounds to 2, 13 / 5 to 3, 2 / 5 to nothing.
  EXPECT_EQ(quantize({{0, 3000}, {1, 4000}}), (std::vector<world::WordCount>{{0, 600}, {1, 800}}));
  EXPECT_EQ(quantize({{0, 3000}, {1, 4000}, {2, 12}, {3, 13}, {4, 2}}),
            (std::vector<world::WordCount>{{0, 600}, {1, 800}, {2, 2}, {3, 3}}));
}

TEST(QuantizeTest, CoarseTakesTheLargestUnitThatKeepsTheCosine) {
  // The norm of (300, 400) is 500, so the unit at most 50: 6 and 8 of it, and nothing is lost.
  EXPECT_EQ(quantize({{0, 300}, {1, 400}}, Detail::kCoarse),
            (std::vector<world::WordCount>{{0, 300}, {1, 400}}));
  // (302, 400) and 2 of each of two more: 6 and 8 of 50 again, cosine 250600 / (500 sqrt(251212)) = .99998.
  EXPECT_EQ(quantize({{0, 302}, {1, 400}, {2, 2}, {3, 2}}, Detail::kCoarse),
            (std::vector<world::WordCount>{{0, 300}, {1, 400}}));
  // Up from five eighths: 31 is less of 50, 32 more.
  EXPECT_EQ(quantize({{0, 300}, {1, 400}, {2, 31}, {3, 32}}, Detail::kCoarse),
            (std::vector<world::WordCount>{{0, 300}, {1, 400}, {3, 50}}));
  // The norm of (3000, 4000) is 5000: told in fifths, as multiples of 100 of these.
  EXPECT_EQ(quantize({{0, 3000}, {1, 4000}, {2, 24}}, Detail::kCoarse),
            (std::vector<world::WordCount>{{0, 600}, {1, 800}}));
  EXPECT_EQ(quantize({{0, 3}, {9, 4}}, Detail::kCoarse), quantize({{0, 3}, {9, 4}}));
}

TEST(QuantizeTest, CoarseKeepsTheCosineAndNoLargerUnitDoes) {
  Random random(11);
  const auto cosine = [](const std::vector<world::WordCount>& a, const std::vector<world::WordCount>& b) {
    std::map<int32_t, double> of_b;
    double aa = 0, bb = 0, ab = 0;
    for (const auto& [word, count] : b) {
      of_b[word] = count;
      bb += static_cast<double>(count) * count;
    }
    for (const auto& [word, count] : a) {
      aa += static_cast<double>(count) * count;
      ab += count * of_b[word];
    }
    return ab / std::sqrt(aa * bb);
  };
  for (int round = 0; round < 50; ++round) {
    std::vector<world::WordCount> counts;  // a few heavy words, many light ones, the norm below 1000
    double squares = 0;
    for (int word = 0; word < 200; ++word) {
      const double u = random.uniform();
      counts.push_back({word, 1 + static_cast<int32_t>(100 * u * u * u * u)});
      squares += static_cast<double>(counts.back().count) * counts.back().count;
    }
    ASSERT_LT(squares, 1e6);
    const auto coarse = quantize(counts, Detail::kCoarse);
    EXPECT_GT(cosine(counts, coarse), 0.99);
    int32_t unit = 0;
    for (const auto& [word, count] : coarse) unit = std::gcd(unit, count);
    ASSERT_GT(unit, 1);
    for (int32_t larger = unit + 1; larger <= static_cast<int32_t>(std::sqrt(squares) / 10); ++larger) {
      std::vector<world::WordCount> rounded;
      for (const auto& [word, count] : counts)
        if (const int32_t level = (8 * count + 3 * larger) / (8 * larger); level > 0)
          rounded.push_back({word, level * larger});
      EXPECT_LE(cosine(counts, rounded), 0.99 + 1e-12) << unit << ' ' << larger;
    }
  }
}

// In steps of 1/63; what was told is told again as it is.
TEST(QuantizeTest, CertaintiesAreNinthsAndCoarseOnesThirds) {
  for (int i = 0; i <= 1000; ++i) {
    const float certainty = static_cast<float>(i) / 1000;
    const int fine = certaintySteps(certainty);
    EXPECT_EQ(fine % 7, 0);
    EXPECT_LE(std::abs(static_cast<float>(fine) / kCertaintySteps - certainty), 1 / 18.f + 1e-6f);
    EXPECT_EQ(certaintySteps(static_cast<float>(fine) / kCertaintySteps), fine);
    const int coarse = certaintySteps(certainty, Detail::kCoarse);
    EXPECT_EQ(coarse % 21, 0);
    EXPECT_LE(std::abs(coarse - fine), 7);
    EXPECT_EQ(certaintySteps(static_cast<float>(coarse) / kCertaintySteps, Detail::kCoarse), coarse);
  }
}

// Words of all groups keep their ratios: a rare group must not weigh as much as a frequent one.
TEST(QuantizeTest, KeepsTheWeightOfARareGroup) {
  const auto quantized = quantize({{5, 100'000}, {5000, 1000}});
  ASSERT_EQ(quantized.size(), 2u);
  EXPECT_EQ(quantized[0].count, 100 * quantized[1].count);
}

TEST(WholePiecesTest, OnePieceATopicAndTwoABrick) {
  const auto pieces = wholePieces(belief(7));
  ASSERT_EQ(pieces.size(), 6u);  // two topics; the cells -1 and 0 lie in two bricks
  for (const Piece& piece : pieces) {
    EXPECT_EQ(piece.version, (world::Version{0, 7}));
    EXPECT_EQ(piece.num_parts, 1);
  }
  EXPECT_EQ(pieces[2].key.index, (std::array<int32_t, 3>{-1, 0, 0}));
}

TEST(WholePiecesTest, ACoarseBeliefTellsCoarsely) {
  LocalBelief coarse = belief(7);
  coarse.topics[0].words = {{1, 3000}, {2, 4000}, {3, 24}};
  coarse.cells[0].certainty = 0.25f;
  coarse.detail = Detail::kCoarse;
  const auto pieces = wholePieces(coarse);
  EXPECT_EQ(std::get<TopicPart>(pieces[0].content).words, quantize(coarse.topics[0].words, Detail::kCoarse));
  EXPECT_EQ(std::get<CertaintyPart>(pieces[4].content).cells[0].steps, 21);  // two ninths, so a third
  EXPECT_EQ(std::get<BrickPart>(pieces[2].content).cells[0].topic, world::TopicId{0});
}

TEST(BeliefChangesTest, SendsOnlyWhatChanged) {
  BeliefChanges changes;
  EXPECT_EQ(changes.update(belief(0)).size(), 6u);
  EXPECT_TRUE(changes.update(belief(1)).empty());
  LocalBelief next = belief(2);
  next.cells[1].certainty = 0.25f;
  const auto changed = changes.update(next);
  ASSERT_EQ(changed.size(), 1u);
  EXPECT_EQ(changed[0].key.kind, PieceKind::kCertainty);
  EXPECT_EQ(changed[0].version.observation, 2);
}

TEST(BeliefChangesTest, SaysOnceThatATopicIsGone) {
  BeliefChanges changes;
  changes.update(belief(0));
  LocalBelief next = belief(1);
  next.topics.pop_back();
  const auto changed = changes.update(next);
  ASSERT_EQ(changed.size(), 1u);
  EXPECT_EQ(std::get<TopicPart>(changed[0].content), (TopicPart{{0}, 0, {10}, {}}));
  next.version.observation = 2;
  EXPECT_TRUE(changes.update(next).empty());
}

// A robot's twins part again (topics/twin_labels.h): a topic that was gone is there once more.
TEST(BeliefChangesTest, SendsATopicThatComesBack) {
  BeliefChanges changes;
  BeliefStore store;
  for (int i = 0; i < 3; ++i) {
    LocalBelief step = belief(i);
    if (i == 1) step.topics.pop_back();
    for (const Piece& piece : changes.update(step)) store.apply(piece);
    store.visit([&](const Piece& piece) {
      const auto* part = std::get_if<TopicPart>(&piece.content);
      if (part == nullptr || piece.key.index[0] != 4) return;
      EXPECT_EQ(part->weight, i == 1 ? 0 : 20);
      EXPECT_EQ(piece.version.observation, i);
    });
  }
}

TEST(BeliefChangesTest, ChangesAddUpToTheWhole) {
  BeliefChanges changes;
  BeliefStore by_changes;
  for (int i = 0; i < 4; ++i) {
    LocalBelief step = belief(i);
    step.topics[0].weight += i;
    step.cells[0].seen.us += i;
    for (const Piece& piece : changes.update(step)) by_changes.apply(piece);
  }
  std::vector<TopicPart> topics;
  by_changes.visit([&](const Piece& piece) {
    if (const auto* part = std::get_if<TopicPart>(&piece.content)) topics.push_back(*part);
  });
  ASSERT_EQ(topics.size(), 2u);
  EXPECT_EQ(topics[0].weight, 33);
}

// A row of 40 bricks with one cell each, seen one after the other.
LocalBelief row(int observation, int changed_from, int changed_until) {
  LocalBelief b = belief(observation);
  b.cells.clear();
  for (int i = 0; i < 40; ++i) {
    const bool changed = i >= changed_from && i < changed_until;
    b.cells.push_back({{16 * i, 0, 0}, world::TopicId{changed ? 4 : 0}, {1000 + i}, 0.5f});
  }
  return b;
}

std::vector<int32_t> bricksOf(const std::vector<Piece>& pieces) {
  std::vector<int32_t> bricks;
  for (const Piece& piece : pieces)
    if (piece.key.kind == PieceKind::kBrick) bricks.push_back(piece.key.index[0]);
  return bricks;
}

TEST(BeliefChangesTest, TellsOfManyBricksWhatWasSeenFirstAndThenWhatWaitedLongest) {
  BeliefChanges changes;
  changes.update(row(0, 0, 0));
  EXPECT_EQ(bricksOf(changes.update(row(1, 10, 20), 4)), (std::vector<int32_t>{10, 11, 12, 13}));
  LocalBelief next = row(2, 0, 20);  // ten more, of which 7 is seen
  next.cells[7].seen.us = 5000;
  EXPECT_EQ(bricksOf(changes.update(next, 4)), (std::vector<int32_t>{7, 14, 15, 16}));
  next.version.observation = 3;
  next.cells[18].topic = world::TopicId{0};  // as it was told: no longer news
  EXPECT_EQ(bricksOf(changes.update(next, 4)), (std::vector<int32_t>{0, 1, 17, 19}));
  next.version.observation = 4;
  const auto rest = changes.update(next);
  EXPECT_EQ(bricksOf(rest), (std::vector<int32_t>{2, 3, 4, 5, 6, 8, 9}));
  for (const Piece& piece : rest) EXPECT_EQ(piece.version.observation, 4);
  EXPECT_TRUE(changes.waiting().empty());
}

LocalBelief mutated(LocalBelief belief, Random& random) {
  ++belief.version.observation;
  for (BelievedCell& cell : belief.cells) {
    if (random.below(4) == 0) cell.topic = world::TopicId{random.below(2) == 0 ? 0 : 4};
    if (random.below(4) == 0) cell.certainty = static_cast<float>(random.below(10)) / 9;
    if (random.below(20) == 0) cell.seen.us = 1000 * belief.version.observation;
  }
  return belief;
}

TEST(BeliefChangesTest, ResumingEqualsNeverHavingStopped) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    BeliefChanges changes;
    BeliefStore store;
    LocalBelief b = row(0, 0, 0);
    for (int step = 0; step < 30; ++step) {
      const auto told = changes.update(b, 1 + random.below(30));
      for (const Piece& piece : told) store.apply(piece);
      BeliefChanges resumed;
      resumed.restore(b, changes.waiting());
      EXPECT_EQ(resumed.waiting(), changes.waiting());
      b = mutated(b, random);
      BeliefChanges unbroken = changes;
      const size_t most = random.below(40);
      EXPECT_EQ(resumed.update(b, most), unbroken.update(b, most));
    }
    for (const Piece& piece : changes.update(b)) store.apply(piece);
    for (const Piece& whole : wholePieces(b)) {  // nothing is left out in the end
      const Piece* held = store.find(whole.key, 0);
      ASSERT_NE(held, nullptr);
      EXPECT_EQ(held->content, whole.content);
    }
  }
}

// Looks through all cells for each question.
class BricksOf final : public BelievedBricks {
 public:
  explicit BricksOf(const LocalBelief& belief) : belief_(belief) {}
  std::vector<BelievedCell> cellsOf(const Brick& brick) const override {
    ++num_given_;
    std::vector<BelievedCell> cells;
    for (const BelievedCell& c : belief_.cells)
      if (brickOf(c.cell) == brick) cells.push_back(c);
    return cells;
  }
  std::optional<Brick> after(const std::optional<Brick>& brick) const override {
    std::optional<Brick> least;
    for (const BelievedCell& c : belief_.cells) {
      const Brick other = brickOf(c.cell);
      if ((!brick || other > *brick) && (!least || other < *least)) least = other;
    }
    return least;
  }
  size_t numGiven() const { return num_given_; }  // bricks, which have one cell each in a row()

 private:
  const LocalBelief& belief_;
  mutable size_t num_given_ = 0;
};

LocalBelief outlineOf(LocalBelief belief) {
  belief.cells.clear();
  return belief;
}

std::set<Brick> seenIn(const LocalBelief& belief, world::Timestamp since) {
  std::set<Brick> seen;
  for (const BelievedCell& c : belief.cells)
    if (c.seen > since) seen.insert(brickOf(c.cell));
  return seen;
}

world::Timestamp latestIn(const LocalBelief& belief) {
  world::Timestamp latest;
  for (const BelievedCell& c : belief.cells) latest = std::max(latest, c.seen);
  return latest;
}

TEST(BeliefChangesTest, BrickByBrickTellsASmallMapAsAWhole) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    BeliefChanges whole, by_brick;
    LocalBelief b = row(0, 0, 0);
    world::Timestamp seen_until;
    for (int step = 0; step < 30; ++step) {
      const size_t most = 1 + random.below(30);
      const auto told = whole.update(b, most);
      EXPECT_EQ(by_brick.update(outlineOf(b), BricksOf(b), seenIn(b, seen_until), most, b.cells.size()),
                told);
      EXPECT_EQ(by_brick.waiting(), whole.waiting());
      EXPECT_EQ(by_brick.waiting(outlineOf(b), BricksOf(b)), whole.waiting());
      seen_until = latestIn(b);
      b = mutated(b, random);
      if (random.below(2) == 0) {
        b.cells.push_back({{16 * (40 + step), 0, 0}, world::TopicId{0}, latestIn(b), 0.5f});
        b.cells.back().seen.us += 1;
      }
    }
  }
}

TEST(BeliefChangesTest, ALookAtALargeMapIsBoundedAndMissesNothing) {
  constexpr size_t kMostBricks = 6, kMostCells = 5, kBricks = 40;
  BeliefChanges changes;
  BeliefStore store;
  LocalBelief b = row(0, 0, 0);
  for (const Piece& piece : changes.update(b)) store.apply(piece);
  b = row(1, 0, 40);  // all of it, and nothing is seen
  for (size_t call = 0; call < kBricks / kMostCells; ++call) {
    const BricksOf bricks(b);
    const auto told = changes.update(outlineOf(b), bricks, {}, kMostBricks, kMostCells);
    EXPECT_EQ(told.size(), kMostCells);  // of each brick the labels
    EXPECT_LE(bricks.numGiven(), kMostCells + kMostBricks);
    for (const Piece& piece : told) store.apply(piece);
    ++b.version.observation;
  }
  for (const Piece& whole : wholePieces(b)) {
    const Piece* held = store.find(whole.key, 0);
    ASSERT_NE(held, nullptr);
    EXPECT_EQ(held->content, whole.content);
  }
  b.cells[7].topic = world::TopicId{0};
  b.cells[7].seen.us += 5000;
  EXPECT_EQ(bricksOf(changes.update(outlineOf(b), BricksOf(b), {Brick{7, 0, 0}}, 1, 0)),
            (std::vector<int32_t>{7}));
}

// Topics come, change and go.
void mutateTopics(LocalBelief& belief, Random& random) {
  std::vector<BelievedTopic> topics;
  for (int32_t id = 0; id < 6; ++id) {
    if (random.below(5) == 0) continue;
    const auto known = std::ranges::find(belief.topics, world::TopicId{id}, &BelievedTopic::id);
    const bool keeps = known != belief.topics.end() && random.below(2) == 0;
    const auto weight = static_cast<int32_t>(1 + random.below(50));
    topics.push_back(keeps ? *known : BelievedTopic{world::TopicId{id}, {0}, weight, {{id, weight}}});
  }
  belief.topics = std::move(topics);
}

TEST(BeliefChangesTest, InTurnsEveryTopicAndSeenBrickIsToldOnceARound) {
  constexpr int32_t kTurns = 5;
  BeliefChanges changes;
  BeliefStore store;
  std::map<PieceKey, int> turn_of;
  Random random(3);
  LocalBelief b = row(0, 0, 0);
  world::Timestamp seen_until;
  for (int step = 0; step < 40; ++step) {
    mutateTopics(b, random);
    for (BelievedCell& cell : b.cells) {  // all are seen
      cell.topic = world::TopicId{4 * (step % 2)};
      cell.seen.us = 5000 + step;
    }
    const auto told = changes.update(outlineOf(b), BricksOf(b), seenIn(b, seen_until), 1000, 0,
                                     {.number = step % kTurns, .of = kTurns});
    size_t bricks = 0;
    for (const Piece& piece : told) {
      store.apply(piece);
      EXPECT_EQ(piece.version.observation, b.version.observation);
      EXPECT_EQ(turn_of.try_emplace(piece.key, step % kTurns).first->second, step % kTurns);
      bricks += piece.key.kind == PieceKind::kBrick;
    }
    EXPECT_EQ(bricks, 40u / kTurns);        // of a row evenly
    EXPECT_EQ(changes.seen().size(), 32u);  // the others wait for theirs
    seen_until = latestIn(b);
    ++b.version.observation;
  }
  for (const Piece& piece : changes.update(b)) store.apply(piece);
  EXPECT_TRUE(changes.seen().empty());
  for (const Piece& whole : wholePieces(b)) {
    const Piece* held = store.find(whole.key, 0);
    ASSERT_NE(held, nullptr);
    EXPECT_EQ(held->content, whole.content);
  }
  store.visitTopics([&](const Piece& piece) {
    const bool is_there =
        std::ranges::find(b.topics, world::TopicId{piece.key.index[0]}, &BelievedTopic::id) != b.topics.end();
    EXPECT_EQ(std::get<TopicPart>(piece.content).weight > 0, is_there);
  });
}

TEST(BeliefChangesTest, ResumingAmidALookEqualsNeverHavingStopped) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    BeliefChanges changes;
    BeliefStore store;
    LocalBelief b = row(0, 0, 0);
    world::Timestamp seen_until;
    for (int step = 0; step < 30; ++step) {
      const auto turn = [&](int number) { return BeliefChanges::Turn{number % 3, 3}; };
      const auto told = changes.update(outlineOf(b), BricksOf(b), seenIn(b, seen_until), 1 + random.below(9),
                                       random.below(12), turn(step));
      for (const Piece& piece : told) store.apply(piece);
      BeliefChanges resumed;
      resumed.restore(b, changes.waiting(outlineOf(b), BricksOf(b)), changes.lookedUntil(), changes.seen());
      seen_until = latestIn(b);
      b = mutated(b, random);
      mutateTopics(b, random);
      BeliefChanges unbroken = changes;
      for (int more = 0; more < 3; ++more) {
        const size_t most = random.below(9), most_cells = random.below(12);
        EXPECT_EQ(resumed.update(outlineOf(b), BricksOf(b), seenIn(b, seen_until), most, most_cells,
                                 turn(step + more)),
                  unbroken.update(outlineOf(b), BricksOf(b), seenIn(b, seen_until), most, most_cells,
                                  turn(step + more)));
      }
    }
    for (const Piece& piece : changes.update(b)) store.apply(piece);
    for (const Piece& whole : wholePieces(b)) {  // nothing is left out in the end
      const Piece* held = store.find(whole.key, 0);
      ASSERT_NE(held, nullptr);
      EXPECT_EQ(held->content, whole.content);
    }
  }
}

}  // namespace
}  // namespace shoal::mapping
