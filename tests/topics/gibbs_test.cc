// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/gibbs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

namespace shoal::topics {
namespace {

// A few cells around one Gibbs, with neighbours as a matrix of weights: the smallest world that has all of
// it.
class TinyWorld {
 public:
  TinyWorld(const Hyperparameters& h, int32_t vocabulary_size, const std::vector<std::vector<int32_t>>& words)
      : gibbs(h, vocabulary_size), hyperparameters_(h) {
    for (const auto& cell_words : words) {
      auto& cell = cells.emplace_back();
      for (const int32_t word : cell_words) cell.push_back({word});
    }
    counts.assign(cells.size(), std::vector<int32_t>(static_cast<size_t>(gibbs.stride())));
  }

  // The first draw of words without a topic is no different.
  void assign(size_t c, uint64_t seed) { resample(c, seed); }
  void resample(size_t c, uint64_t seed) {
    gibbs.resample(cells[c], counts[c], neighborCounts(c), Random(seed, c));
  }
  void resampleOne(size_t c, size_t i, uint64_t seed) {
    gibbs.resample(std::span(cells[c]).subspan(i, 1), counts[c], neighborCounts(c), Random(seed, c, i));
  }

  // Every cell adjoins the one before and the one after.
  std::vector<float> neighborCounts(size_t c) const {
    std::vector<float> sum(static_cast<size_t>(gibbs.stride()));
    for (const size_t other : {c - 1, c + 1}) {
      if (other >= cells.size()) continue;
      for (size_t k = 0; k < sum.size(); ++k)
        sum[k] += static_cast<float>(hyperparameters_.neighbor_weight * counts[other][k]);
    }
    return sum;
  }

  // n_kw, n_k, n_ck and the open slots follow from the tokens alone.
  void expectCountsMatchTokens() const {
    std::map<std::pair<int32_t, int32_t>, int32_t> word_counts;
    std::map<int32_t, int64_t> topic_counts;
    for (size_t c = 0; c < cells.size(); ++c) {
      std::vector<int32_t> expected(static_cast<size_t>(gibbs.stride()));
      for (const Token& token : cells[c]) {
        if (token.slot < 0) continue;
        ++expected[static_cast<size_t>(token.slot)];
        ++word_counts[{token.word, token.slot}];
        ++topic_counts[token.slot];
      }
      ASSERT_EQ(counts[c], expected);
    }
    for (int32_t k = 0; k < gibbs.stride(); ++k) {
      ASSERT_EQ(gibbs.topicCount(k), topic_counts[k]);
      if (k < gibbs.slots().size()) {
        ASSERT_EQ(gibbs.slots().isOpen(k), topic_counts[k] > 0);
      }
      for (int32_t w = 0; w < gibbs.vocabularySize(); ++w) {
        ASSERT_EQ(gibbs.wordCounts(w)[static_cast<size_t>(k)], (word_counts[{w, k}]));
      }
    }
  }

  Gibbs gibbs;
  std::vector<std::vector<Token>> cells;
  std::vector<std::vector<int32_t>> counts;

 private:
  Hyperparameters hyperparameters_;
};

// Without neighbours the conditionals are those of one joint distribution, that of LDA:
// Π_k [Π_w Γ(n_kw + β) / Γ(n_k + Vβ)] Π_ck Γ(n_ck + α), which four words in two cells let us list in full.
TEST(GibbsTest, VisitsLabelingsAsOftenAsTheExactPosteriorSays) {
  const int32_t num_topics = 3, vocabulary_size = 3;
  const Hyperparameters h{.max_topics = num_topics, .alpha = 0.3, .beta = 0.5, .neighbor_weight = 0.0};
  const std::vector<std::vector<int32_t>> words = {{0, 0}, {1, 0}};
  const int num_states = 81;

  std::vector<double> posterior;
  for (int state = 0; state < num_states; ++state) {
    const std::vector<int> z = {state % 3, state / 3 % 3, state / 9 % 3, state / 27};
    double n_kw[3][3] = {}, n_k[3] = {}, n_ck[2][3] = {};
    for (size_t i = 0; i < 4; ++i) {
      const auto k = static_cast<size_t>(z[i]);
      n_kw[k][words[i / 2][i % 2]] += 1;
      n_k[k] += 1;
      n_ck[i / 2][k] += 1;
    }
    double log_p = 0;
    for (int k = 0; k < 3; ++k) {
      for (int w = 0; w < 3; ++w) log_p += std::lgamma(n_kw[k][w] + h.beta);
      log_p -= std::lgamma(n_k[k] + vocabulary_size * h.beta);
      for (int c = 0; c < 2; ++c) log_p += std::lgamma(n_ck[c][k] + h.alpha);
    }
    posterior.push_back(std::exp(log_p));
  }
  const double total = std::accumulate(posterior.begin(), posterior.end(), 0.0);

  TinyWorld world(h, vocabulary_size, words);
  world.assign(0, 0);
  world.assign(1, 0);
  std::vector<double> seen(num_states);
  const int num_samples = 400'000;
  for (int i = 1; i <= num_samples; ++i) {
    world.resample(0, static_cast<uint64_t>(i));
    world.resample(1, static_cast<uint64_t>(i));
    const auto &a = world.cells[0], &b = world.cells[1];
    ++seen[static_cast<size_t>(a[0].slot + 3 * a[1].slot + 9 * b[0].slot + 27 * b[1].slot)];
  }
  // The chain forgets within about ten sweeps, so a share p is off by some sqrt(10 p / samples) <= .0015.
  for (size_t state = 0; state < num_states; ++state) {
    const double p = posterior[state] / total;
    EXPECT_NEAR(seen[state] / num_samples, p, 5.0 * std::sqrt(10.0 * p / num_samples)) << "state " << state;
  }
}

// The shares of word i of cell 1, worked out here from the formula of the header, neighbours and new topic
// included.
std::vector<double> sharesByHand(const TinyWorld& world, const Hyperparameters& h, size_t i) {
  const Token token = world.cells[1][i];
  const auto countWithout = [&](int32_t k) { return world.gibbs.topicCount(k) - (k == token.slot ? 1 : 0); };
  // The one unused slot that may open: the word's own if it is alone there, else the first.
  int32_t option = 0;
  while (option < h.max_topics && countWithout(option) > 0) ++option;
  if (countWithout(token.slot) == 0) option = token.slot;

  std::vector<double> share;
  for (int32_t k = 0; k < h.max_topics; ++k) {
    const auto at = static_cast<size_t>(k);
    const int32_t own = k == token.slot ? 1 : 0;
    const double n_kw = world.gibbs.wordCounts(token.word)[at] - own;
    const auto n_k = static_cast<double>(countWithout(k));
    const double n_ck =
        world.counts[1][at] - own + h.neighbor_weight * (world.counts[0][at] + world.counts[2][at]);
    const double unused = h.gamma == 0.0 ? 1.0 : k == option ? h.gamma : 0.0;
    const double g = n_k > 0.0 ? 1.0 : unused;
    share.push_back(g * (n_kw + h.beta) / (n_k + world.gibbs.vocabularySize() * h.beta) * (n_ck + h.alpha));
  }
  const double total = std::accumulate(share.begin(), share.end(), 0.0);
  for (double& p : share) p /= total;
  return share;
}

// From many states of a chain, one word is drawn again and again while all the others stand still.
class ConditionalTest : public testing::TestWithParam<double> {};

TEST_P(ConditionalTest, DrawsEachTopicAsOftenAsTheFormulaSays) {
  const Hyperparameters h{.max_topics = 7, .alpha = 0.7, .beta = 0.9, .gamma = GetParam()};
  TinyWorld world(h, 4, {{0, 1, 2, 2}, {2, 3, 0}, {1, 1}});
  for (size_t c = 0; c < 3; ++c) world.assign(c, 5);
  int num_lone_words = 0, num_gaps = 0;  // the corners of the rule: were they tried?
  for (uint64_t state = 0; state < 40; ++state) {
    for (size_t c = 0; c < 3; ++c) world.resample(c, state);
    for (size_t i = 0; i < world.cells[1].size(); ++i) {
      const std::vector<double> share = sharesByHand(world, h, i);
      const bool alone = world.gibbs.topicCount(world.cells[1][i].slot) == 1;
      num_lone_words += alone && world.gibbs.slots().firstClosed() < world.cells[1][i].slot;
      num_gaps += world.gibbs.slots().end() - world.gibbs.slots().numOpen() > 1;
      std::vector<double> drawn(share.size());
      const int num_draws = 5000;
      for (int draw = 0; draw < num_draws; ++draw) {
        TinyWorld after = world;
        after.resampleOne(1, i, static_cast<uint64_t>(draw));
        ++drawn[static_cast<size_t>(after.cells[1][i].slot)];
      }
      for (size_t k = 0; k < share.size(); ++k) {
        const double p = share[k];
        if (p == 0.0) {
          EXPECT_EQ(drawn[k], 0.0);
        }
        EXPECT_NEAR(drawn[k], num_draws * p, 5.0 * std::sqrt(num_draws * p * (1.0 - p)) + 2.0)
            << "word " << i;
      }
    }
  }
  EXPECT_GT(num_lone_words, 0);
  EXPECT_GT(num_gaps, 0);
}

INSTANTIATE_TEST_SUITE_P(FixedAndGrowing, ConditionalTest, testing::Values(0.0, 0.4, 2.0));

// A large new-topic weight keeps topics coming and going.
TEST(GibbsTest, CountsMatchTheTokensAfterEveryMove) {
  for (const double gamma : {0.0, 3.0}) {
    SCOPED_TRACE(gamma);
    Random random(17);
    std::vector<std::vector<int32_t>> words(4);
    for (auto& cell : words) {
      for (int i = 0; i < 6; ++i) cell.push_back(static_cast<int32_t>(random.below(7)));
    }
    TinyWorld world({.max_topics = 6, .gamma = gamma}, 7, words);
    for (size_t c = 0; c < words.size(); ++c) {
      world.assign(c, 1);
      world.expectCountsMatchTokens();
    }
    int32_t fewest = world.gibbs.slots().numOpen(), most = fewest;
    for (uint64_t sweep = 0; sweep < 50; ++sweep) {
      for (size_t c = 0; c < words.size(); ++c) {
        for (size_t i = 0; i < words[c].size(); ++i) {
          world.resampleOne(c, i, sweep);
          ASSERT_NO_FATAL_FAILURE(world.expectCountsMatchTokens());
          fewest = std::min(fewest, world.gibbs.slots().numOpen());
          most = std::max(most, world.gibbs.slots().numOpen());
        }
      }
    }
    EXPECT_LT(fewest, most);  // else opening and closing were not tried
  }
}

TEST(GibbsTest, TheFirstWordOpensTheFirstSlotWhateverGamma) {
  TinyWorld world({.gamma = 1e-30}, 3, {{1}});
  world.assign(0, 0);
  EXPECT_EQ(world.cells[0][0].slot, 0);
  for (uint64_t i = 0; i < 100; ++i) world.resample(0, i);
  EXPECT_EQ(world.cells[0][0].slot, 0);  // alone in its topic, it keeps it
}

TEST(GibbsTest, NothingOpensOnceTheIdsHaveRunOut) {
  for (const double gamma : {0.0, 1.0}) {
    // A large alpha: three words part and meet for ever, until the ids are gone.
    TinyWorld world({.max_topics = 3, .alpha = 10.0, .gamma = gamma}, 2, {{0, 1, 0}});
    world.assign(0, 0);
    uint64_t sweep = 0;
    while (world.gibbs.slots().canOpen()) {
      ASSERT_LT(++sweep, 1'000'000u);
      world.resample(0, sweep);
      world.gibbs.nameTopics({});
    }
    int32_t open = world.gibbs.slots().numOpen();
    for (int i = 0; i < 1000; ++i) {
      world.resample(0, ++sweep);
      ASSERT_LE(world.gibbs.slots().numOpen(), open);
      open = world.gibbs.slots().numOpen();
    }
    EXPECT_EQ(open, 1);
    EXPECT_EQ(world.gibbs.slots().numIdsUsed(), 10000);
    world.expectCountsMatchTokens();
  }
}

TEST(GibbsTest, RejectsAVocabularyItCannotHold) {
  EXPECT_THROW(Gibbs({}, 0), std::invalid_argument);
  EXPECT_THROW(Gibbs({}, -1), std::invalid_argument);
  EXPECT_THROW(Gibbs({.max_topics = 10000}, 1'000'000), std::invalid_argument);
  EXPECT_THROW(Gibbs({.alpha = 0.0}, 10), std::invalid_argument);
}

}  // namespace
}  // namespace shoal::topics
