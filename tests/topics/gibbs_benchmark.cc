// SPDX-License-Identifier: BSD-3-Clause
// How many words a second one core re-samples, beside a plain sampler in the same run: topic-major double
// counts and std::discrete_distribution, as one would write it from the formula. Only the ratio of the two
// means anything on a shared machine. Corpus: 20 planted topics over 5000 words, 64 x 64 cells of 30 words,
// patches of 8 x 8 cells alike, up to 4 neighbours a cell.
#include <benchmark/benchmark.h>

#include <array>
#include <cstdint>
#include <map>
#include <random>
#include <span>
#include <vector>

#include "shoal/random.h"
#include "shoal/topics/topic_model.h"

namespace {

using shoal::topics::Hyperparameters;
using shoal::world::CellWords;
using shoal::world::WordsInCells;

constexpr int32_t kTopics = 20;
constexpr int32_t kVocabulary = 5000;
constexpr int32_t kSide = 64;
constexpr int32_t kWordsInCell = 30;
constexpr double kAlpha = 0.1;
constexpr double kBeta = 0.1;
constexpr double kNeighborWeight = 0.5;

// Zipf-like inside each topic: a skewed draw from a topic's own scattering of the vocabulary.
int32_t plantedWord(uint64_t topic, shoal::Random& random) {
  const double u = random.uniform();
  const auto rank = static_cast<uint64_t>(u * u * u * 800.0);
  return static_cast<int32_t>(shoal::hashCombine(topic, rank) % kVocabulary);
}

WordsInCells corpus() {
  WordsInCells image;
  shoal::Random random(7);
  for (int32_t x = 0; x < kSide; ++x) {
    for (int32_t y = 0; y < kSide; ++y) {
      const uint64_t topic =
          shoal::hashCombine(static_cast<uint64_t>(x / 8), static_cast<uint64_t>(y / 8)) % kTopics;
      std::map<int32_t, int32_t> counts;
      for (int32_t i = 0; i < kWordsInCell; ++i) ++counts[plantedWord(topic, random)];
      CellWords& cell = image.cells.emplace_back(CellWords{{x, y, 0}, {}});
      for (const auto& [word, count] : counts) cell.words.push_back({word, count});
    }
  }
  return image;
}

void topicModel(benchmark::State& state) {
  Hyperparameters hyperparameters;
  hyperparameters.max_topics = kTopics;
  hyperparameters.alpha = kAlpha;
  hyperparameters.beta = kBeta;
  hyperparameters.neighbor_weight = kNeighborWeight;
  hyperparameters.local_rate = 0.0;
  hyperparameters.tau = 1.0;
  shoal::topics::TopicModel model(hyperparameters, kVocabulary, 1, shoal::world::RobotId{0});
  model.add(corpus());
  const int64_t sweep = int64_t{kSide} * kSide * kWordsInCell;
  model.refine(20 * sweep);  // past the first, unusually busy sweeps
  const int64_t before = model.numResamples();
  for (auto _ : state) model.refine(sweep);
  state.SetItemsProcessed(model.numResamples() - before);
}
BENCHMARK(topicModel)->Unit(benchmark::kMillisecond)->MinTime(2.0);

void snapshot(benchmark::State& state) {
  Hyperparameters hyperparameters;
  shoal::topics::TopicModel model(hyperparameters, 15436, 1, shoal::world::RobotId{0});
  WordsInCells image;
  shoal::Random random(9);
  for (int32_t c = 0; c < 20000; ++c) {
    std::map<int32_t, int32_t> counts;
    for (int32_t i = 0; i < 30; ++i) ++counts[static_cast<int32_t>(random.below(15436))];
    CellWords& cell = image.cells.emplace_back(CellWords{{c / 200, c % 200, 0}, {}});
    for (const auto& [word, count] : counts) cell.words.push_back({word, count});
  }
  model.add(image);
  for (auto _ : state) benchmark::DoNotOptimize(model.snapshot());
}
BENCHMARK(snapshot)->Unit(benchmark::kMillisecond);

// The plain sampler. Sweeps the cells in order.
class PlainSampler {
 public:
  explicit PlainSampler(const WordsInCells& image) {
    for (const CellWords& from : image.cells) {
      Cell& cell = cells_.emplace_back();
      for (const auto& [word, count] : from.words)
        cell.words.insert(cell.words.end(), static_cast<size_t>(count), word);
      for (const int32_t word : cell.words) {
        const auto k = static_cast<int32_t>(rng_() % kTopics);
        cell.topics.push_back(k);
        count(cell, word, k, 1.0);
      }
    }
  }

  int64_t sweep() {
    int64_t resampled = 0;
    std::vector<double> weight(kTopics);
    for (int32_t c = 0; c < kSide * kSide; ++c) {
      Cell& cell = cells_[static_cast<size_t>(c)];
      std::array<double, kTopics> neighbors{};
      const int32_t x = c / kSide, y = c % kSide;
      for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        if (x + dx < 0 || x + dx >= kSide || y + dy < 0 || y + dy >= kSide) continue;
        const Cell& other = cells_[static_cast<size_t>((x + dx) * kSide + y + dy)];
        for (size_t k = 0; k < kTopics; ++k) neighbors[k] += kNeighborWeight * other.counts[k];
      }
      for (size_t i = 0; i < cell.words.size(); ++i) {
        const auto w = static_cast<size_t>(cell.words[i]);
        count(cell, cell.words[i], cell.topics[i], -1.0);
        for (size_t k = 0; k < kTopics; ++k) {
          weight[k] = (topic_words_[k][w] + kBeta) / (totals_[k] + kVocabulary * kBeta) *
                      (cell.counts[k] + neighbors[k] + kAlpha);
        }
        std::discrete_distribution<int32_t> distribution(weight.begin(), weight.end());
        cell.topics[i] = distribution(rng_);
        count(cell, cell.words[i], cell.topics[i], 1.0);
        ++resampled;
      }
    }
    return resampled;
  }

 private:
  struct Cell {
    std::vector<int32_t> words, topics;
    std::array<double, kTopics> counts{};
  };

  void count(Cell& cell, int32_t word, int32_t topic, double change) {
    const auto k = static_cast<size_t>(topic);
    topic_words_[k][static_cast<size_t>(word)] += change;
    totals_[k] += change;
    cell.counts[k] += change;
  }

  std::vector<Cell> cells_;
  std::vector<std::vector<double>> topic_words_{kTopics, std::vector<double>(kVocabulary)};
  std::array<double, kTopics> totals_{};
  std::mt19937_64 rng_{1};
};

void plainSampler(benchmark::State& state) {
  PlainSampler sampler(corpus());
  for (int i = 0; i < 20; ++i) sampler.sweep();
  int64_t resampled = 0;
  for (auto _ : state) resampled += sampler.sweep();
  state.SetItemsProcessed(resampled);
}
BENCHMARK(plainSampler)->Unit(benchmark::kMillisecond)->MinTime(2.0);

}  // namespace

BENCHMARK_MAIN();
