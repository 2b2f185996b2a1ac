// SPDX-License-Identifier: BSD-3-Clause
// TopicModel draws many cells side by side, with denominators that are a little old (gibbs.h). Whether what
// it learns is as good as what the formula says, word by word and with every count exact, is seen in how well
// the topics explain the words, after as many visits by the same law from the same kind of start.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "shoal/random.h"
#include "shoal/topics/topic_model.h"

namespace shoal::topics {
namespace {

constexpr size_t kTopics = 6;
constexpr size_t kVocabulary = 300;
constexpr int32_t kSide = 12;
constexpr int kWordsInCell = 30;
constexpr int kSweeps = 30;
constexpr double kAlpha = 0.1, kBeta = 0.1, kNeighborWeight = 0.5;

// Patches of 3 x 3 cells; words of a patch come from one topic's 60, or, one in five, from anywhere.
world::WordsInCells corpus() {
  world::WordsInCells image;
  Random random(7);
  for (int32_t x = 0; x < kSide; ++x) {
    for (int32_t y = 0; y < kSide; ++y) {
      const uint64_t topic =
          hashCombine(static_cast<uint64_t>(x / 3), static_cast<uint64_t>(y / 3)) % kTopics;
      std::map<int32_t, int32_t> counts;
      for (int i = 0; i < kWordsInCell; ++i) {
        const uint64_t word =
            random.below(5) == 0 ? random.below(kVocabulary) : (topic * 50 + random.below(60)) % kVocabulary;
        ++counts[static_cast<int32_t>(word)];
      }
      world::CellWords& cell = image.cells.emplace_back(world::CellWords{{x, y, 0}, {}});
      for (const auto& [word, count] : counts) cell.words.push_back({word, count});
    }
  }
  return image;
}

using Counts = std::array<std::array<double, kVocabulary>, kTopics>;  // n_kw

// exp(- mean ln p(w)), p(w) = Σ_k θ_ck φ_kw, θ of each cell by expectation maximisation: of the topics alone.
double perplexity(const Counts& counts, const world::WordsInCells& image) {
  Counts phi = counts;
  for (auto& topic : phi) {
    double total = 0;
    for (double& n : topic) total += (n += kBeta);
    for (double& n : topic) n /= total;
  }
  double log = 0, words = 0;
  for (const world::CellWords& cell : image.cells) {
    std::array<double, kTopics> theta;
    theta.fill(1.0 / kTopics);
    double log_of_cell = 0;
    for (int step = 0; step < 30; ++step) {
      std::array<double, kTopics> next{};
      log_of_cell = 0;
      for (const auto& [word, count] : cell.words) {
        double p = 0;
        for (size_t k = 0; k < kTopics; ++k) p += theta[k] * phi[k][static_cast<size_t>(word)];
        for (size_t k = 0; k < kTopics; ++k)
          next[k] += count * theta[k] * phi[k][static_cast<size_t>(word)] / (p * kWordsInCell);
        log_of_cell += count * std::log(p);
      }
      theta = next;
    }
    log += log_of_cell;
    words += kWordsInCell;
  }
  return std::exp(-log / words);
}

Counts learnt(const world::WordsInCells& image, uint64_t seed) {
  Hyperparameters h;
  h.max_topics = kTopics;
  h.alpha = kAlpha;
  h.beta = kBeta;
  h.gamma = 0;
  h.neighbor_weight = kNeighborWeight;
  h.local_rate = 0;
  h.tau = 1;
  TopicModel model(h, kVocabulary, seed, world::RobotId{0});
  model.add(image);
  model.refine(int64_t{kSweeps} * kSide * kSide * kWordsInCell);
  Counts counts{};
  size_t k = 0;
  for (const TopicCounts& topic : model.snapshot().topics) {
    for (const auto& [word, count] : topic.words) counts[k][static_cast<size_t>(word)] = count;
    ++k;
  }
  return counts;
}

// The formula, word after word, with every count exact; visits by the law of schedule.h.
class Exact {
 public:
  // First draws, cell after cell, each from what was drawn before.
  Exact(const world::WordsInCells& image, uint64_t seed) : random_(seed, 99) {
    for (const world::CellWords& from : image.cells) {
      Cell& cell = cells_.emplace_back();
      for (const auto& [word, count] : from.words)
        for (int i = 0; i < count; ++i) cell.words.push_back({static_cast<size_t>(word), 0});
    }
    for (int32_t c = 0; c < kSide * kSide; ++c) draw(c, true);
  }

  void refine(int visits) {
    for (int i = 0; i < visits; ++i) draw(static_cast<int32_t>(random_.below(kSide * kSide)), false);
  }

  Counts counts{};

 private:
  struct Cell {
    std::vector<std::pair<size_t, size_t>> words;  // word, topic
    std::array<double, kTopics> counts{};
  };
  void draw(int32_t c, bool is_first) {
    Cell& cell = cells_[static_cast<size_t>(c)];
    for (auto& [word, topic] : cell.words) {
      if (!is_first) add(cell, word, topic, -1);
      std::array<double, kTopics> weight{};
      double sum = 0;
      for (size_t k = 0; k < kTopics; ++k) {
        double around = cell.counts[k] + kAlpha;
        for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
          const int32_t x = c / kSide + dx, y = c % kSide + dy;
          if (x < 0 || x >= kSide || y < 0 || y >= kSide) continue;
          around += kNeighborWeight * cells_[static_cast<size_t>(x * kSide + y)].counts[k];
        }
        sum += weight[k] = (counts[k][word] + kBeta) / (totals_[k] + kVocabulary * kBeta) * around;
      }
      double point = random_.uniform() * sum;
      topic = 0;
      while (topic + 1 < kTopics && point >= weight[topic]) point -= weight[topic++];
      add(cell, word, topic, 1);
    }
  }
  void add(Cell& cell, size_t word, size_t topic, double change) {
    cell.counts[topic] += change;
    counts[topic][word] += change;
    totals_[topic] += change;
  }
  Random random_;
  std::vector<Cell> cells_;
  std::array<double, kTopics> totals_{};
};

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + std::ssize(values) / 2);
  return values[values.size() / 2];
}

TEST(PerplexityTest, IsThatOfTheExactSamplerInTheMedianOverSeeds) {
  const world::WordsInCells image = corpus();
  std::vector<double> ours, exact;
  for (uint64_t seed = 0; seed < 101; ++seed) {
    ours.push_back(perplexity(learnt(image, seed), image));
    Exact sampler(image, seed);
    sampler.refine(kSweeps * kSide * kSide);
    exact.push_back(perplexity(sampler.counts, image));
  }
  EXPECT_NEAR(median(ours) / median(exact), 1.0, 0.01);
  EXPECT_LT(median(exact), 0.6 * kVocabulary);  // something was learnt
}

}  // namespace
}  // namespace shoal::topics
