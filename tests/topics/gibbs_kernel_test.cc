// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/gibbs_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "shoal/random.h"

namespace shoal::topics {
namespace {

constexpr int32_t kWords = 37;

// A table and lanes over it with random tokens, counts that fit them, and some slots that may not be drawn.
struct World {
  World(uint64_t seed, int32_t num_topics, int32_t num_lanes, bool all_eligible, double opening_mass)
      : random(seed),
        stride(static_cast<size_t>((num_topics + kSlotsTogether - 1) / kSlotsTogether * kSlotsTogether)),
        lanes(static_cast<int32_t>(stride)) {
    table.stride = table.num_slots = static_cast<int32_t>(stride);
    table.beta = 0.3F;
    table.beta_sum = kWords * 0.3F;
    table.opening_mass = static_cast<float>(opening_mass);
    word_counts.resize(kWords * stride);
    outside.resize(stride);
    open.resize(stride);
    topic_counts.resize(stride);
    eligible.resize(stride);
    inverse.resize(stride);
    for (size_t k = 0; k < static_cast<size_t>(num_topics); ++k) {
      const bool is_open = all_eligible || k == 0 || random.below(3) > 0;
      eligible[k] = is_open ? 1.0F : 0.0F;
      open[k] = is_open ? -1 : 0;
      for (size_t w = 0; is_open && w < kWords; ++w) {
        const auto n = static_cast<int32_t>(1 + random.below(20));
        word_counts[w * stride + k] += n;
        outside[k] += n;
      }
    }
    tokens.resize(static_cast<size_t>(num_lanes));
    for (int32_t i = 0; i < num_lanes; ++i) running.push_back(i * 5 % kLanes);  // no particular order
    for (size_t i = 0; i < tokens.size(); ++i) {
      const auto j = static_cast<size_t>(running[i]);
      const size_t size = 5 + random.below(10);
      for (size_t t = 0; t < size; ++t) {
        Token token{static_cast<int32_t>(random.below(kWords)), -1};
        if (random.below(5) > 0) {
          do token.slot = static_cast<int32_t>(random.below(static_cast<uint64_t>(num_topics)));
          while (eligible[static_cast<size_t>(token.slot)] == 0.0F);
          ++word_counts[static_cast<size_t>(token.word) * stride + static_cast<size_t>(token.slot)];
          ++lanes.counts[static_cast<size_t>(token.slot) * kLanes + j];
        }
        tokens[i].push_back(token);
      }
      lanes.counter[j] = static_cast<uint32_t>(random());
      lanes.key[j] = static_cast<uint32_t>(random());
      for (size_t k = 0; k < stride; ++k) lanes.prior[k * kLanes + j] = static_cast<float>(random.uniform());
    }
  }

  // A copy's pointers lead into the copy.
  void bind() {
    table.word_counts = word_counts.data();
    table.outside = outside.data();
    table.open = open.data();
    table.eligible = eligible.data();
    for (size_t i = 0; i < tokens.size(); ++i) {
      const auto j = static_cast<size_t>(running[i]);
      lanes.next[j] = tokens[i].data();
      lanes.end[j] = lanes.next[j] + tokens[i].size();
    }
  }

  Totals refreshed() {
    return refresh(table, lanes, running.data(), static_cast<int32_t>(running.size()), topic_counts.data(),
                   inverse.data());
  }
  Drawn drawn(int32_t max_rounds, int32_t max_finished) {
    return drawRounds(table, inverse.data(), lanes, running.data(), static_cast<int32_t>(running.size()),
                      max_rounds, max_finished);
  }
  size_t numDrawn(size_t i) const {
    return static_cast<size_t>(lanes.next[static_cast<size_t>(running[i])] - tokens[i].data());
  }

  Random random;
  Table table;
  size_t stride;
  AlignedVector<int32_t> word_counts, outside, open, topic_counts;
  AlignedVector<float> eligible, inverse;
  Lanes lanes;
  std::vector<int32_t> running;
  std::vector<std::vector<Token>> tokens;
};

// What the header says, in plain loops: the exact shares, in double.
std::vector<double> shares(const World& world, size_t i, size_t at) {
  const auto j = static_cast<size_t>(world.running[i]);
  const Token token = world.tokens[i][at];
  std::vector<double> share;
  for (size_t k = 0; k < world.stride; ++k) {
    const int32_t own = token.slot == static_cast<int32_t>(k) ? 1 : 0;
    const double n_kw = world.word_counts[static_cast<size_t>(token.word) * world.stride + k] - own;
    const double n_ck = double{world.lanes.counts[k * kLanes + j]} - own;
    share.push_back((n_kw + double{world.table.beta}) * double{world.inverse[k]} *
                    (n_ck + double{world.lanes.prior[k * kLanes + j]}));
  }
  return share;
}

// n_kw and n_ck as moves of some tokens leave them.
void expectMoved(const World& before, const World& after, size_t num_slots) {
  auto word_counts = before.word_counts;
  auto cell_counts = before.lanes.counts;
  for (size_t i = 0; i < before.tokens.size(); ++i) {
    const auto j = static_cast<size_t>(before.running[i]);
    for (size_t t = 0; t < before.tokens[i].size(); ++t) {
      const Token old = before.tokens[i][t], now = after.tokens[i][t];
      ASSERT_EQ(old.word, now.word);
      if (t >= after.numDrawn(i)) {
        ASSERT_EQ(old.slot, now.slot);
      }
      if (old.slot == now.slot) continue;
      ASSERT_GE(now.slot, 0);
      ASSERT_LT(static_cast<size_t>(now.slot), num_slots);
      const auto row = static_cast<size_t>(old.word) * before.stride;
      if (old.slot >= 0) {
        --word_counts[row + static_cast<size_t>(old.slot)];
        --cell_counts[static_cast<size_t>(old.slot) * kLanes + j];
      }
      ++word_counts[row + static_cast<size_t>(now.slot)];
      ++cell_counts[static_cast<size_t>(now.slot) * kLanes + j];
    }
  }
  ASSERT_EQ(word_counts, after.word_counts);
  ASSERT_EQ(cell_counts, after.lanes.counts);
}

struct Kind {
  int32_t num_topics;
  bool all_eligible;
  double opening_mass;
};
const std::vector<Kind> kKinds = {{1, true, 0},     {7, true, 0},      {12, true, 0},   {20, true, 0},
                                  {32, true, 0},    {77, true, 0},     {12, false, 0},  {20, false, 0.02},
                                  {31, false, 0.2}, {50, false, 1e-3}, {5, false, 0.05}};

class GibbsKernelTest : public testing::Test {
 protected:
  ~GibbsKernelTest() override { useGibbsTarget(0); }
};

// One token of one lane from the same state again and again, with other random numbers.
TEST_F(GibbsKernelTest, DrawsAsOftenAsTheFormulaSays) {
  for (const Kind& kind : kKinds) {
    World first(5, kind.num_topics, 3, kind.all_eligible, kind.opening_mass);
    first.bind();
    first.refreshed();
    const std::vector<double> share = shares(first, 2, 0);
    double total = first.table.opening_mass;
    for (const double s : share) total += s;
    std::vector<double> drawn(share.size());
    double opened = 0;
    const int num_draws = 4000;
    Random random(9);
    for (int n = 0; n < num_draws; ++n) {
      World world = first;
      world.bind();
      const auto j = static_cast<size_t>(world.running[2]);
      world.lanes.counter[j] = static_cast<uint32_t>(random());
      world.lanes.key[j] = static_cast<uint32_t>(random());
      const Drawn result =
          drawRounds(world.table, world.inverse.data(), world.lanes, &world.running[2], 1, 1, 1);
      ASSERT_NO_FATAL_FAILURE(expectMoved(first, world, share.size()));
      ASSERT_EQ(result.num_drawn, result.opening < 0 ? 1 : 0);
      if (result.opening >= 0) {
        ASSERT_EQ(result.opening, world.running[2]);
        ++opened;
      } else {
        ++drawn[static_cast<size_t>(world.tokens[2][0].slot)];
      }
    }
    const auto expectOften = [&](double count, double p) {
      if (p == 0.0) {
        EXPECT_EQ(count, 0.0);
      }
      EXPECT_NEAR(count, num_draws * p, 5.0 * std::sqrt(num_draws * p * (1.0 - p)) + 2.0) << kind.num_topics;
    };
    for (size_t k = 0; k < share.size(); ++k) expectOften(drawn[k], share[k] / total);
    expectOften(opened, double{first.table.opening_mass} / total);
  }
}

// Lanes of one round do not see each other draw: each draws what it would alone.
TEST_F(GibbsKernelTest, ARoundIsDrawnFromTheCountsBeforeIt) {
  World first(3, 20, kLanes, true, 0);
  first.bind();
  first.refreshed();
  World together = first;
  together.bind();
  EXPECT_EQ(together.drawn(1, kLanes).num_drawn, kLanes);
  for (size_t i = 0; i < first.tokens.size(); ++i) {
    World alone = first;
    alone.bind();
    drawRounds(alone.table, alone.inverse.data(), alone.lanes, &alone.running[i], 1, 1, 1);
    EXPECT_EQ(together.tokens[i][0].slot, alone.tokens[i][0].slot);
    EXPECT_EQ(together.numDrawn(i), 1u);
  }
}

TEST_F(GibbsKernelTest, EveryInstructionSetGivesTheSameBytesAndCountsFollowTheMoves) {
  ASSERT_FALSE(gibbsTargets().empty());
  int num_opened = 0;
  for (size_t kind = 0; kind < kKinds.size(); ++kind) {
    const auto& [num_topics, all_eligible, mass] = kKinds[kind];
    for (const int32_t num_lanes : {1, 3, 8, 11, 16}) {
      World first(100 + kind, num_topics, num_lanes, all_eligible, mass);
      World expected = first;
      expected.bind();
      useGibbsTarget(gibbsTargets().back());
      const Totals expected_totals = expected.refreshed();
      first.inverse = expected.inverse;
      const Drawn expected_drawn = expected.drawn(12, std::max(1, num_lanes / 2));
      ASSERT_NO_FATAL_FAILURE(expectMoved(first, expected, first.stride));
      num_opened += expected_drawn.opening >= 0;
      size_t all_drawn = 0;
      for (size_t i = 0; i < first.tokens.size(); ++i) all_drawn += expected.numDrawn(i);
      EXPECT_EQ(static_cast<size_t>(expected_drawn.num_drawn), all_drawn);
      for (const int64_t target : gibbsTargets()) {
        useGibbsTarget(target);
        World world = first;
        world.bind();
        const Totals totals = world.refreshed();
        EXPECT_EQ(totals.max_inverse, expected_totals.max_inverse);
        EXPECT_EQ(totals.num_words, expected_totals.num_words);
        EXPECT_EQ(totals.stale, expected_totals.stale);
        ASSERT_EQ(world.inverse, expected.inverse);
        ASSERT_EQ(world.topic_counts, expected.topic_counts);
        const Drawn drawn = world.drawn(12, std::max(1, num_lanes / 2));
        EXPECT_EQ(drawn.num_drawn, expected_drawn.num_drawn);
        EXPECT_EQ(drawn.opening, expected_drawn.opening);
        ASSERT_EQ(world.word_counts, expected.word_counts) << target << ' ' << num_topics;
        ASSERT_EQ(world.lanes.counts, expected.lanes.counts) << target << ' ' << num_topics;
        for (size_t i = 0; i < world.tokens.size(); ++i) {
          EXPECT_EQ(world.numDrawn(i), expected.numDrawn(i));
          for (size_t t = 0; t < world.tokens[i].size(); ++t) {
            ASSERT_EQ(world.tokens[i][t].slot, expected.tokens[i][t].slot);
          }
        }
      }
    }
  }
  EXPECT_GT(num_opened, 5);
}

TEST_F(GibbsKernelTest, RefreshCountsTheLanesNamedAndFindsWhatHasOpenedOrClosed) {
  World world(1, 12, 2, true, 0);
  world.bind();
  const Totals totals = world.refreshed();
  EXPECT_FALSE(totals.stale);
  float largest = 0;
  int64_t all = 0;
  for (size_t k = 0; k < 12; ++k) {
    int32_t n = world.outside[k];
    for (const int32_t j : world.running)
      n += static_cast<int32_t>(world.lanes.counts[k * kLanes + static_cast<size_t>(j)]);
    EXPECT_EQ(world.topic_counts[k], n);
    EXPECT_FLOAT_EQ(world.inverse[k], 1.0F / (static_cast<float>(n) + world.table.beta_sum));
    largest = std::max(largest, world.inverse[k]);
    all += n;
  }
  EXPECT_EQ(totals.max_inverse, largest);
  EXPECT_EQ(totals.num_words, all);
  world.lanes.counts[3 * kLanes + 7] = 9;  // of a lane that is not named
  EXPECT_EQ(world.refreshed().num_words, all);
  world.open[3] = 0;
  EXPECT_TRUE(world.refreshed().stale);
}

}  // namespace
}  // namespace shoal::topics
