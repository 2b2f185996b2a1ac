// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/gibbs.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "shoal/demand.h"

namespace shoal::topics {
namespace {

constexpr float kMaxStaleness = 1.0F / 16.0F;  // of n_k + Vβ
constexpr int64_t kWordsPerDraw = 256;         // or so many words for each that is drawn
constexpr int32_t kMaxDraws = 512;             // words from one n_k
constexpr int32_t kLeaveTogether = 4;          // cells: each stop costs

int32_t roundUp(int32_t n, int32_t multiple) { return (n + multiple - 1) / multiple * multiple; }

int32_t checked(const Hyperparameters& hyperparameters, int32_t vocabulary_size) {
  check(hyperparameters);
  const int64_t entries = int64_t{vocabulary_size} * roundUp(hyperparameters.max_topics, kSlotsTogether);
  if (vocabulary_size < 1 || entries > int64_t{1} << 31) {
    throw std::invalid_argument("vocabulary_size must be at least 1 and times max_topics at most 2^31, got " +
                                std::to_string(vocabulary_size));
  }
  return vocabulary_size;
}

// Never rounded to nothing.
float asMass(double mass) { return std::max(static_cast<float>(mass), std::numeric_limits<float>::min()); }

}  // namespace

Gibbs::Gibbs(const Hyperparameters& hyperparameters, int32_t vocabulary_size)
    : hyperparameters_(hyperparameters),
      vocabulary_size_(checked(hyperparameters, vocabulary_size)),
      slots_(hyperparameters.max_topics),
      opening_mass_(hyperparameters.gamma * hyperparameters.alpha / vocabulary_size),
      lanes_(roundUp(hyperparameters.max_topics, kSlotsTogether)) {
  table_.stride = roundUp(hyperparameters.max_topics, kSlotsTogether);
  table_.beta = static_cast<float>(hyperparameters.beta);
  table_.beta_sum = static_cast<float>(vocabulary_size * hyperparameters.beta);
  const auto num_slots = static_cast<size_t>(stride());
  word_counts_.resize(static_cast<size_t>(vocabulary_size) * num_slots);
  outside_.resize(num_slots);
  topic_counts_.resize(num_slots);
  open_.resize(num_slots);
  eligible_.resize(num_slots);
  inverse_.resize(num_slots);
  std::iota(running_.begin(), running_.end(), 0);
  noteSlots();
}

void Gibbs::enter(int32_t cell, std::span<Token> tokens, std::span<int32_t> cell_counts,
                  std::span<const float> neighbor_counts, Random random) {
  SHOAL_DEMAND(num_entered_ < kLanes && !tokens.empty());
  const int32_t lane = running_[static_cast<size_t>(num_entered_)];
  const auto j = static_cast<size_t>(lane);
  visits_[static_cast<size_t>(num_entered_++)] = {cell, lane, cell_counts.data()};
  lanes_.next[j] = tokens.data();
  lanes_.end[j] = tokens.data() + tokens.size();
  const uint64_t key = random();
  lanes_.counter[j] = static_cast<uint32_t>(key);
  lanes_.key[j] = static_cast<uint32_t>(key >> 32);
  const auto alpha = static_cast<float>(hyperparameters_.alpha);
  for (size_t k = 0; k < cell_counts.size(); ++k) {
    lanes_.counts[k * kLanes + j] = static_cast<float>(cell_counts[k]);
    lanes_.prior[k * kLanes + j] = neighbor_counts[k] + alpha;
    outside_[k] -= cell_counts[k];
  }
}

void Gibbs::advance() {
  SHOAL_DEMAND(num_entered_ > 0);
  num_left_ = 0;
  if (num_drawn_ >= may_draw_) refreshAll();
  int32_t num_running = num_entered_;
  bool exact = one_by_one_ || may_draw_ <= 1;
  if (hyperparameters_.gamma > 0.0 && !exact && isConfined(num_entered_)) {
    num_running = 1;
    exact = isConfined(1);
  }
  if (exact) {
    refreshAll();
    drawOne();
  } else {
    drawTogether(num_running);
  }
  leave();
  if (num_entered_ == 0) refreshAll();
}

void Gibbs::resample(std::span<Token> tokens, std::span<int32_t> cell_counts,
                     std::span<const float> neighbor_counts, Random random) {
  SHOAL_DEMAND(num_entered_ == 0);
  enter(0, tokens, cell_counts, neighbor_counts, random);
  while (num_entered_ > 0) advance();
}

void Gibbs::addCounts(int32_t slot, std::span<const world::WordCount> words, int sign) {
  SHOAL_DEMAND(num_entered_ == 0);
  const auto k = static_cast<size_t>(slot);
  const bool was_used = outside_[k] > 0;
  for (const world::WordCount& w : words) {
    row(w.word)[k] += sign * w.count;
    outside_[k] += sign * w.count;
    SHOAL_DEMAND(row(w.word)[k] >= 0);
  }
  if (!was_used && outside_[k] > 0 && !slots_.isOpen(slot)) slots_.open(slot);
  if (was_used && outside_[k] == 0) slots_.close(slot);
  noteSlots();
}

void Gibbs::restoreTopics(int32_t num_ids_used, std::span<const TopicSlots::Named> open) {
  slots_.restore(num_ids_used, open);
  noteSlots();
}

std::span<const int32_t> Gibbs::wordCounts(int32_t word) const {
  return std::span(word_counts_)
      .subspan(static_cast<size_t>(word) * static_cast<size_t>(stride()), static_cast<size_t>(stride()));
}

const Table& Gibbs::table() {
  table_.word_counts = word_counts_.data();
  table_.outside = outside_.data();
  table_.open = open_.data();
  table_.eligible = eligible_.data();
  return table_;
}

// What follows from which slots are open. n_k is to be worked out anew.
void Gibbs::noteSlots() {
  const bool fixed = hyperparameters_.gamma == 0.0;
  for (int32_t k = 0; k < slots_.size(); ++k) {
    open_[static_cast<size_t>(k)] = slots_.isOpen(k) ? -1 : 0;
    eligible_[static_cast<size_t>(k)] = slots_.isOpen(k) || (fixed && slots_.canOpen()) ? 1.0F : 0.0F;
  }
  table_.num_slots = fixed ? stride() : roundUp(slots_.end(), kSlotsTogether);
  const bool may_open = !fixed && slots_.canOpen() && slots_.firstClosed() < slots_.size();
  table_.opening_mass = may_open ? asMass(opening_mass_) : 0.0F;
  one_by_one_ = fixed && slots_.canOpen() && slots_.numIdsLeft() < slots_.size();
  num_drawn_ = may_draw_ = 0;
}

// Counts and denominators as they are now; opens the slots that have got words and closes those that have
// lost them.
void Gibbs::refreshAll() {
  const auto again = [&] {
    return refresh(table(), lanes_, running_.data(), num_entered_, topic_counts_.data(), inverse_.data());
  };
  Totals totals = again();
  if (totals.stale) {
    for (const bool opening : {false, true}) {  // ids of topics that die unnamed serve those that open
      for (int32_t k = 0; k < slots_.size(); ++k) {
        const bool used = topic_counts_[static_cast<size_t>(k)] > 0;
        if (used == slots_.isOpen(k) || used != opening) continue;
        if (used) {
          slots_.open(k);
        } else {
          slots_.close(k);
        }
      }
    }
    noteSlots();
    totals = again();
  }
  const float of_least = std::min(kMaxStaleness / totals.max_inverse, static_cast<float>(kMaxDraws));
  const auto of_all = static_cast<int32_t>(std::min<int64_t>(totals.num_words / kWordsPerDraw, kMaxDraws));
  may_draw_ = std::max(static_cast<int32_t>(of_least), of_all);
  num_drawn_ = 0;
}

// Has an open topic no word outside the first so many cells?
bool Gibbs::isConfined(int32_t num_running) const {
  for (int32_t k = 0; k < slots_.end(); ++k) {
    if (!slots_.isOpen(k)) continue;
    int32_t outside = outside_[static_cast<size_t>(k)];
    for (int32_t i = num_running; i < num_entered_; ++i) {
      outside += static_cast<int32_t>(
          lanes_.counts[static_cast<size_t>(k * kLanes + running_[static_cast<size_t>(i)])]);
    }
    if (outside == 0) return true;
  }
  return false;
}

// Words of the first so many cells, until n_k is to be worked out anew or some have all theirs drawn.
void Gibbs::drawTogether(int32_t num_running) {
  const int32_t left = std::max(1, may_draw_ - num_drawn_);
  num_running = std::min(num_running, left);
  const Drawn drawn = drawRounds(table(), inverse_.data(), lanes_, running_.data(), num_running,
                                 left / num_running, kLeaveTogether);
  num_drawn_ += drawn.num_drawn;
  if (drawn.opening >= 0) openTopic(drawn.opening);
}

// The next token of the first cell, all counts exact. After refresh().
void Gibbs::drawOne() {
  const int32_t lane = running_[0];
  const int32_t own = lanes_.next[static_cast<size_t>(lane)]->slot;
  const float opening_mass = table_.opening_mass;
  bool stays_if_opening = false;
  if (own >= 0) {
    const auto k = static_cast<size_t>(own);
    const int32_t others = topic_counts_[k] - 1;
    inverse_[k] = 1.0F / (static_cast<float>(others) + table_.beta_sum);
    stays_if_opening = others == 0 && hyperparameters_.gamma > 0.0;
    if (stays_if_opening) {
      // Without this word the topic is unused, and there is one unused option: its own slot.
      inverse_[k] = 0.0F;
      table_.opening_mass = asMass(opening_mass_);
    }
  }
  const int32_t opening = drawRounds(table(), inverse_.data(), lanes_, running_.data(), 1, 1, 1).opening;
  table_.opening_mass = opening_mass;
  num_drawn_ = may_draw_;
  if (opening < 0) return;
  if (stays_if_opening) {
    ++lanes_.next[static_cast<size_t>(lane)];
  } else {
    openTopic(opening);
  }
}

void Gibbs::openTopic(int32_t lane) {
  const auto j = static_cast<size_t>(lane);
  const auto count = [&](int32_t slot) -> float& {
    return lanes_.counts[static_cast<size_t>(slot) * kLanes + j];
  };
  Token& token = *lanes_.next[j]++;
  if (token.slot >= 0) {
    --row(token.word)[token.slot];
    --count(token.slot);
  }
  token.slot = slots_.firstClosed();
  ++row(token.word)[token.slot];
  ++count(token.slot);
  num_drawn_ = may_draw_;
}

void Gibbs::leave() {
  int32_t num_staying = 0;
  for (int32_t i = 0; i < num_entered_; ++i) {
    const Visit visit = visits_[static_cast<size_t>(i)];
    const auto j = static_cast<size_t>(visit.lane);
    if (lanes_.next[j] != lanes_.end[j]) {
      std::swap(running_[static_cast<size_t>(num_staying)], running_[static_cast<size_t>(i)]);
      visits_[static_cast<size_t>(num_staying++)] = visit;
      continue;
    }
    for (size_t k = 0; k < outside_.size(); ++k) {
      visit.counts[k] = static_cast<int32_t>(lanes_.counts[k * kLanes + j]);
      outside_[k] += visit.counts[k];
    }
    left_[static_cast<size_t>(num_left_++)] = visit.cell;
  }
  num_entered_ = num_staying;
}

}  // namespace shoal::topics
