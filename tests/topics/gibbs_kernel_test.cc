// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/gibbs_kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "shoal/random.h"

namespace shoal::topics {
namespace {

constexpr int32_t kWords = 37;

// A table and chains over it with random tokens, counts that fit them, and some slots that may not be drawn.
struct World {
  World(uint64_t seed, int32_t num_topics, int32_t num_chains, bool all_eligible, double opening_mass)
      : random(seed) {
    table.num_vectors = (num_topics + kLanes - 1) / kLanes;
    stride = static_cast<size_t>(table.num_vectors * kLanes);
    table.beta = 0.3F;
    table.beta_sum = kWords * 0.3F;
    table.opening_mass = opening_mass;
    table.all_eligible = all_eligible;
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
        const auto n = static_cast<int32_t>(random.below(20));
        word_counts[w * stride + k] += n;
        outside[k] += n;
      }
    }
    chains.resize(static_cast<size_t>(num_chains));
    tokens.resize(chains.size());
    cell_counts.assign(chains.size(), std::vector<int32_t>(stride));
    for (size_t j = 0; j < chains.size(); ++j) {
      const size_t size = 10 + random.below(30);
      for (size_t i = 0; i < size; ++i) {
        Token token{static_cast<int32_t>(random.below(kWords)), -1};
        if (random.below(5) > 0) {
          do token.slot = static_cast<int32_t>(random.below(static_cast<uint64_t>(num_topics)));
          while (eligible[static_cast<size_t>(token.slot)] == 0.0F);
          ++word_counts[static_cast<size_t>(token.word) * stride + static_cast<size_t>(token.slot)];
          ++cell_counts[j][static_cast<size_t>(token.slot)];
        }
        tokens[j].push_back(token);
        chains[j].uniforms.push_back(static_cast<float>(random.below(1 << 23)) * 0x1p-23F + 0x1p-24F);
        chains[j].opening_uniforms.push_back(random.uniform());
      }
      for (size_t k = 0; k < stride; ++k) chains[j].prior.push_back(static_cast<float>(random.uniform()));
    }
  }

  // A copy's pointers lead into the copy.
  void bind() {
    table.word_counts = word_counts.data();
    table.outside = outside.data();
    table.open = open.data();
    table.eligible = eligible.data();
    for (size_t j = 0; j < chains.size(); ++j) {
      chains[j].tokens = tokens[j].data();
      chains[j].size = static_cast<int32_t>(tokens[j].size());
      chains[j].counts = cell_counts[j].data();
    }
  }

  Totals refreshed(int32_t num_running) {
    return refresh(table, chains.data(), static_cast<int32_t>(chains.size()), num_running,
                   topic_counts.data(), inverse.data());
  }

  Random random;
  Table table;
  size_t stride = 0;
  AlignedVector<int32_t> word_counts, outside, open, topic_counts;
  AlignedVector<float> eligible, inverse;
  std::vector<Chain> chains;
  std::vector<std::vector<Token>> tokens;
  std::vector<std::vector<int32_t>> cell_counts;
};

// What the header says, in plain loops: exact shares in double, and the point of the uniform among them in
// the order of lanes, then vectors. Draws too close to a border for float to tell are left to the kernel.
bool drawByHand(World& world, size_t j, int32_t drawn, int& num_checked) {
  const Chain& chain = world.chains[j];
  const auto at = static_cast<size_t>(chain.next);
  const Token token = world.tokens[j][at];
  std::vector<double> weight;
  double total = 0;
  for (size_t k = 0; k < world.stride; ++k) {
    const int32_t own = token.slot == static_cast<int32_t>(k) ? 1 : 0;
    const double n_kw = world.word_counts[static_cast<size_t>(token.word) * world.stride + k] - own;
    const double n_ck = world.cell_counts[j][k] - own;
    weight.push_back((n_kw + double{world.table.beta}) * double{world.inverse[k]} *
                     (n_ck + double{chain.prior[k]}));
    total += weight.back();
  }
  const double mass = world.table.opening_mass;
  const bool opens = mass > 0 && chain.opening_uniforms[at] * (total + mass) < mass;
  EXPECT_EQ(opens, drawn < 0);
  if (opens || drawn < 0) return !opens == (drawn >= 0);
  EXPECT_GT(weight[static_cast<size_t>(drawn)], 0.0);
  const double point = chain.uniforms[at] * total;
  double below = 0;
  for (size_t lane = 0; lane < kLanes; ++lane) {
    for (size_t v = 0; v < world.stride / kLanes; ++v) {
      const size_t k = v * kLanes + lane;
      const double end = below + weight[k];
      const double margin = 1e-5 * total;
      if (point > below + margin && point < end - margin) {
        ++num_checked;
        EXPECT_EQ(drawn, static_cast<int32_t>(k));
        return drawn == static_cast<int32_t>(k);
      }
      below = end;
    }
  }
  return true;
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

TEST_F(GibbsKernelTest, DrawsWhatTheFormulaSays) {
  int num_checked = 0;
  for (const int64_t target : gibbsTargets()) {
    useGibbsTarget(target);
    for (size_t kind = 0; kind < kKinds.size(); ++kind) {
      const auto& [num_topics, all_eligible, mass] = kKinds[kind];
      World world(kind, num_topics, 1, all_eligible, mass);
      world.bind();
      world.refreshed(1);
      for (Chain& chain = world.chains[0]; chain.next < chain.size;) {
        World before = world;
        const Token old = world.tokens[0][static_cast<size_t>(chain.next)];
        const int32_t opening = drawRounds(world.table, world.inverse.data(), &chain, 1, 1);
        const Token now = world.tokens[0][static_cast<size_t>(before.chains[0].next)];
        ASSERT_TRUE(drawByHand(before, 0, opening < 0 ? now.slot : -1, num_checked)) << num_topics;
        // Counts follow the move, and nothing else changes.
        if (opening < 0) {
          const auto word = static_cast<size_t>(old.word) * world.stride;
          if (old.slot >= 0) {
            --before.word_counts[word + static_cast<size_t>(old.slot)];
            --before.cell_counts[0][static_cast<size_t>(old.slot)];
          }
          ++before.word_counts[word + static_cast<size_t>(now.slot)];
          ++before.cell_counts[0][static_cast<size_t>(now.slot)];
        }
        ASSERT_EQ(world.word_counts, before.word_counts);
        ASSERT_EQ(world.cell_counts, before.cell_counts);
        if (opening >= 0) ++chain.next;
      }
    }
  }
  EXPECT_GT(num_checked, 200);
}

// One of each chain in turn, as if they were drawn one by one; the same bytes from every instruction set.
TEST_F(GibbsKernelTest, TurnsAreASequenceAndEveryInstructionSetGivesTheSameBytes) {
  ASSERT_FALSE(gibbsTargets().empty());
  for (size_t kind = 0; kind < kKinds.size(); ++kind) {
    const auto& [num_topics, all_eligible, mass] = kKinds[kind];
    for (int32_t num_chains = 1; num_chains <= kMaxChains; ++num_chains) {
      World first(100 + kind, num_topics, num_chains, all_eligible, mass);
      World expected = first;
      int32_t expected_opening = -1;
      expected.bind();
      useGibbsTarget(gibbsTargets().back());
      const Totals expected_totals = expected.refreshed(1);
      for (int32_t turn = 0; turn < 10 * num_chains && expected_opening < 0; ++turn) {
        const int32_t j = turn % num_chains;
        if (drawRounds(expected.table, expected.inverse.data(), &expected.chains[static_cast<size_t>(j)], 1,
                       1) == 0) {
          expected_opening = j;
        }
      }
      for (const int64_t target : gibbsTargets()) {
        useGibbsTarget(target);
        World world = first;
        world.bind();
        const Totals totals = world.refreshed(1);
        EXPECT_EQ(totals.max_inverse, expected_totals.max_inverse);
        EXPECT_EQ(totals.stale, expected_totals.stale);
        EXPECT_EQ(totals.confined, expected_totals.confined);
        ASSERT_EQ(world.inverse, expected.inverse);
        ASSERT_EQ(world.topic_counts, expected.topic_counts);
        EXPECT_EQ(drawRounds(world.table, world.inverse.data(), world.chains.data(), num_chains, 10),
                  expected_opening);
        ASSERT_EQ(world.word_counts, expected.word_counts) << target << ' ' << num_topics;
        ASSERT_EQ(world.cell_counts, expected.cell_counts) << target << ' ' << num_topics;
        for (size_t j = 0; j < world.chains.size(); ++j) {
          EXPECT_EQ(world.chains[j].next, expected.chains[j].next);
          for (size_t i = 0; i < world.tokens[j].size(); ++i) {
            ASSERT_EQ(world.tokens[j][i].slot, expected.tokens[j][i].slot);
          }
        }
      }
    }
  }
}

TEST_F(GibbsKernelTest, RefreshFindsWhatHasOpenedClosedOrIsConfined) {
  World world(1, 12, 2, true, 0);
  world.bind();
  EXPECT_FALSE(world.refreshed(2).stale);
  EXPECT_FALSE(world.refreshed(2).confined);
  float largest = 0;
  for (size_t k = 0; k < 12; ++k) {
    const int32_t n = world.outside[k] + world.cell_counts[0][k] + world.cell_counts[1][k];
    EXPECT_EQ(world.topic_counts[k], n);
    EXPECT_FLOAT_EQ(world.inverse[k], 1.0F / (static_cast<float>(n) + world.table.beta_sum));
    largest = std::max(largest, world.inverse[k]);
  }
  EXPECT_EQ(world.refreshed(2).max_inverse, largest);
  world.cell_counts[0][3] = 1;  // a topic of these two cells alone
  world.cell_counts[1][3] = 2;
  world.outside[3] = 0;
  EXPECT_TRUE(world.refreshed(2).confined);
  EXPECT_FALSE(world.refreshed(1).confined);
  EXPECT_FALSE(world.refreshed(2).stale);
  world.open[3] = 0;
  EXPECT_TRUE(world.refreshed(2).stale);
  EXPECT_FALSE(world.refreshed(2).confined);
}

}  // namespace
}  // namespace shoal::topics
