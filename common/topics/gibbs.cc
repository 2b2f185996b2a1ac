// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/gibbs.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "shoal/demand.h"

namespace shoal::topics {
namespace {

constexpr int32_t kLanes = 4;  // slots weighed together; a fixed count lets any compiler vectorise

int32_t roundUp(int32_t n, int32_t multiple) { return (n + multiple - 1) / multiple * multiple; }

int32_t checked(const Hyperparameters& hyperparameters, int32_t vocabulary_size) {
  check(hyperparameters);
  const int64_t entries = int64_t{vocabulary_size} * roundUp(hyperparameters.max_topics, 8);
  if (vocabulary_size < 1 || entries > int64_t{1} << 31) {
    throw std::invalid_argument("vocabulary_size must be at least 1 and times max_topics at most 2^31, got " +
                                std::to_string(vocabulary_size));
  }
  return vocabulary_size;
}

}  // namespace

Gibbs::Gibbs(const Hyperparameters& hyperparameters, int32_t vocabulary_size)
    : hyperparameters_(hyperparameters),
      vocabulary_size_(checked(hyperparameters, vocabulary_size)),
      stride_(roundUp(hyperparameters.max_topics, 8)),
      beta_sum_(vocabulary_size * hyperparameters.beta),
      slots_(hyperparameters.max_topics) {
  const auto num_slots = static_cast<size_t>(stride_);
  word_counts_.resize(static_cast<size_t>(vocabulary_size) * num_slots);
  topic_counts_.resize(num_slots);
  inverse_.assign(num_slots, 1.0 / beta_sum_);
  inverse_less_.resize(num_slots);
  factor_.resize(num_slots);
  factor_less_.resize(num_slots);
  weight_.resize(num_slots);
}

void Gibbs::assign(std::span<Token> tokens, std::span<int32_t> cell_counts,
                   std::span<const double> neighbor_counts, Random random) {
  enter(cell_counts, neighbor_counts);
  for (Token& token : tokens) {
    SHOAL_DEMAND(token.slot == -1);
    weigh(row(token.word));
    token.slot = draw(random.uniform());
    put(token, cell_counts, neighbor_counts);
  }
}

void Gibbs::resample(std::span<Token> tokens, std::span<int32_t> cell_counts,
                     std::span<const double> neighbor_counts, Random random) {
  enter(cell_counts, neighbor_counts);
  for (Token& token : tokens) {
    const int32_t old = token.slot;
    const auto o = static_cast<size_t>(old);
    // Weighed with the word still in; then the one topic that holds it is put right.
    weigh(row(token.word));
    weight_[o] = (row(token.word)[old] - 1 + hyperparameters_.beta) * factor_less_[o];
    if (topic_counts_[o] == 1 && hyperparameters_.gamma > 0.0) [[unlikely]] {
      // Without this word the topic is unused, and there is one unused option: its own slot.
      weight_[o] *= hyperparameters_.gamma;
      if (slots_.firstClosed() < width_) weight_[static_cast<size_t>(slots_.firstClosed())] = 0.0;
    }
    const int32_t drawn = draw(random.uniform());
    if (drawn == old) continue;
    take(token.word, old, cell_counts, neighbor_counts);
    token.slot = drawn;
    put(token, cell_counts, neighbor_counts);
  }
}

void Gibbs::addCounts(int32_t slot, std::span<const world::WordCount> words, int sign) {
  const auto k = static_cast<size_t>(slot);
  int64_t& count = topic_counts_[k];
  const bool was_used = count > 0;
  for (const world::WordCount& w : words) {
    row(w.word)[k] += sign * w.count;
    count += sign * w.count;
    SHOAL_DEMAND(row(w.word)[k] >= 0);
  }
  inverse_[k] = 1.0 / (static_cast<double>(count) + beta_sum_);
  inverse_less_[k] = 1.0 / (static_cast<double>(count - 1) + beta_sum_);
  if (!was_used && count > 0 && !slots_.isOpen(slot)) slots_.open(slot);
  if (was_used && count == 0) slots_.close(slot);
}

std::span<const int32_t> Gibbs::wordCounts(int32_t word) const {
  return std::span(word_counts_)
      .subspan(static_cast<size_t>(word) * static_cast<size_t>(stride_), static_cast<size_t>(stride_));
}

// g_k for the next word.
double Gibbs::openness(int32_t slot) const {
  if (slots_.isOpen(slot)) return 1.0;
  if (!slots_.canOpen()) return 0.0;
  if (hyperparameters_.gamma == 0.0) return 1.0;
  return slot == slots_.firstClosed() ? hyperparameters_.gamma : 0.0;
}

// Prepares the factors that do not depend on the word; again whenever a topic opens or closes.
void Gibbs::enter(std::span<const int32_t> cell_counts, std::span<const double> neighbor_counts) {
  int32_t end = slots_.end();
  if (slots_.canOpen()) {
    const bool all = hyperparameters_.gamma == 0.0;
    end = std::max(end, all ? slots_.size() : std::min(slots_.firstClosed() + 1, slots_.size()));
  }
  width_ = roundUp(end, kLanes);
  for (int32_t k = 0; k < end; ++k) {
    updateFactors(k, cell_counts[static_cast<size_t>(k)], neighbor_counts[static_cast<size_t>(k)]);
  }
  std::fill(factor_.begin() + end, factor_.begin() + width_, 0.0);
}

void Gibbs::updateFactors(int32_t slot, int32_t cell_count, double neighbor_count) {
  const auto k = static_cast<size_t>(slot);
  factor_[k] = openness(slot) * (cell_count + neighbor_count + hyperparameters_.alpha) * inverse_[k];
  factor_less_[k] = (cell_count - 1 + neighbor_count + hyperparameters_.alpha) * inverse_less_[k];
}

void Gibbs::weigh(const int32_t* row) {
  const double beta = hyperparameters_.beta;
  const double* __restrict factor = factor_.data();
  double* __restrict weight = weight_.data();
  for (int32_t first = 0; first < width_; first += kLanes) {
    for (int32_t k = first; k < first + kLanes; ++k) weight[k] = (row[k] + beta) * factor[k];
  }
}

// The slot in whose share of the total weight the point `uniform` falls. Never one of weight 0: its
// running sum equals the one before it.
int32_t Gibbs::draw(double uniform) {
  double* __restrict sum = weight_.data();
  for (int32_t k = 1; k < width_; ++k) sum[k] += sum[k - 1];
  const double point = uniform * sum[width_ - 1];
  int32_t drawn = 0;
  for (int32_t first = 0; first < width_; first += kLanes) {
    for (int32_t k = first; k < first + kLanes; ++k) drawn += sum[k] <= point;
  }
  SHOAL_DEMAND(drawn < width_);
  return drawn;
}

void Gibbs::put(const Token& token, std::span<int32_t> cell_counts, std::span<const double> neighbor_counts) {
  const auto k = static_cast<size_t>(token.slot);
  ++row(token.word)[k];
  ++cell_counts[k];
  const int64_t count = ++topic_counts_[k];
  inverse_less_[k] = inverse_[k];
  inverse_[k] = 1.0 / (static_cast<double>(count) + beta_sum_);
  if (count == 1) {
    slots_.open(token.slot);
    enter(cell_counts, neighbor_counts);
  } else {
    updateFactors(token.slot, cell_counts[k], neighbor_counts[k]);
  }
}

void Gibbs::take(int32_t word, int32_t slot, std::span<int32_t> cell_counts,
                 std::span<const double> neighbor_counts) {
  const auto k = static_cast<size_t>(slot);
  --row(word)[k];
  --cell_counts[k];
  const int64_t count = --topic_counts_[k];
  inverse_[k] = inverse_less_[k];
  inverse_less_[k] = 1.0 / (static_cast<double>(count - 1) + beta_sum_);
  if (count == 0) {
    slots_.close(slot);
    enter(cell_counts, neighbor_counts);
  } else {
    updateFactors(slot, cell_counts[k], neighbor_counts[k]);
  }
}

}  // namespace shoal::topics
