// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/gibbs.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "shoal/demand.h"

namespace shoal::topics {
namespace {

constexpr float kMaxStaleness = 1.0F / 16.0F;  // of n_k + Vβ within a block
constexpr int32_t kMaxBlock = 128;             // tokens

int32_t roundUp(int32_t n, int32_t multiple) { return (n + multiple - 1) / multiple * multiple; }

int32_t checked(const Hyperparameters& hyperparameters, int32_t vocabulary_size) {
  check(hyperparameters);
  const int64_t entries = int64_t{vocabulary_size} * roundUp(hyperparameters.max_topics, kLanes);
  if (vocabulary_size < 1 || entries > int64_t{1} << 31) {
    throw std::invalid_argument("vocabulary_size must be at least 1 and times max_topics at most 2^31, got " +
                                std::to_string(vocabulary_size));
  }
  return vocabulary_size;
}

// The midpoint of one of 2^23 equal parts of (0, 1); exact in float.
float midpoint(uint64_t bits) {
  return (static_cast<float>(static_cast<int32_t>(bits & 0x7fffff)) + 0.5F) * 0x1p-23F;
}

}  // namespace

Gibbs::Gibbs(const Hyperparameters& hyperparameters, int32_t vocabulary_size)
    : hyperparameters_(hyperparameters),
      vocabulary_size_(checked(hyperparameters, vocabulary_size)),
      slots_(hyperparameters.max_topics) {
  table_.num_vectors = roundUp(hyperparameters.max_topics, kLanes) / kLanes;
  table_.beta = static_cast<float>(hyperparameters.beta);
  table_.beta_sum = static_cast<float>(vocabulary_size * hyperparameters.beta);
  const auto num_slots = static_cast<size_t>(stride());
  word_counts_.resize(static_cast<size_t>(vocabulary_size) * num_slots);
  outside_.resize(num_slots);
  topic_counts_.resize(num_slots);
  open_.resize(num_slots);
  eligible_.resize(num_slots);
  inverse_.resize(num_slots);
  noteSlots();
}

void Gibbs::enter(int32_t cell, std::span<Token> tokens, std::span<int32_t> cell_counts,
                  std::span<const float> neighbor_counts, Random random) {
  SHOAL_DEMAND(num_chains_ < kMaxChains);
  Chain& chain = chains_[static_cast<size_t>(num_chains_++)];
  chain.cell = cell;
  chain.tokens = tokens.data();
  chain.size = static_cast<int32_t>(tokens.size());
  chain.next = 0;
  chain.counts = cell_counts.data();
  const auto alpha = static_cast<float>(hyperparameters_.alpha);
  chain.prior.resize(neighbor_counts.size());
  for (size_t k = 0; k < neighbor_counts.size(); ++k) {
    chain.prior[k] = neighbor_counts[k] + alpha;
    outside_[k] -= cell_counts[k];
  }
  chain.uniforms.resize(tokens.size() + 1);
  for (size_t i = 0; i < tokens.size(); i += 2) {
    const uint64_t bits = random();
    chain.uniforms[i] = midpoint(bits);
    chain.uniforms[i + 1] = midpoint(bits >> 32);
  }
  if (hyperparameters_.gamma == 0.0) return;
  chain.opening_uniforms.resize(tokens.size());
  for (double& uniform : chain.opening_uniforms) uniform = random.uniform();
}

void Gibbs::advance() {
  SHOAL_DEMAND(num_chains_ > 0);
  int32_t rounds = std::numeric_limits<int32_t>::max();
  for (int32_t j = 0; j < num_chains_; ++j) {
    const Chain& chain = chains_[static_cast<size_t>(j)];
    rounds = std::min(rounds, chain.size - chain.next);
  }
  const int32_t together = std::min(blockLength(refreshAll(num_chains_)) / num_chains_, rounds);
  if (together > 1) {
    drawBlock(num_chains_, together);
  } else if (rounds > 0) {
    const int32_t alone = num_chains_ == 1 ? 1 : blockLength(refreshAll(1));
    if (alone > 1) {
      drawBlock(1, std::min(alone, chains_[0].size - chains_[0].next));
    } else {
      drawOne();
    }
  }
  leave();
  if (num_chains_ == 0) refreshAll(0);
}

void Gibbs::resample(std::span<Token> tokens, std::span<int32_t> cell_counts,
                     std::span<const float> neighbor_counts, Random random) {
  SHOAL_DEMAND(num_chains_ == 0);
  enter(0, tokens, cell_counts, neighbor_counts, random);
  while (num_chains_ > 0) advance();
}

void Gibbs::addCounts(int32_t slot, std::span<const world::WordCount> words, int sign) {
  SHOAL_DEMAND(num_chains_ == 0);
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

// What follows from which slots are open.
void Gibbs::noteSlots() {
  const bool fixed = hyperparameters_.gamma == 0.0;
  for (int32_t k = 0; k < slots_.size(); ++k) {
    open_[static_cast<size_t>(k)] = slots_.isOpen(k) ? -1 : 0;
    eligible_[static_cast<size_t>(k)] = slots_.isOpen(k) || (fixed && slots_.canOpen()) ? 1.0F : 0.0F;
  }
  table_.all_eligible = fixed && slots_.canOpen();
  const bool may_open = !fixed && slots_.canOpen() && slots_.firstClosed() < slots_.size();
  table_.opening_mass = may_open ? hyperparameters_.gamma * hyperparameters_.alpha / vocabulary_size_ : 0.0;
  one_by_one_ = fixed && slots_.canOpen() && slots_.numIdsLeft() < slots_.size();
}

// Counts and denominators as they are now; opens the slots that have got words and closes those that have
// lost them.
Totals Gibbs::refreshAll(int32_t num_running) {
  const auto again = [&] {
    return refresh(table(), chains_.data(), num_chains_, num_running, topic_counts_.data(), inverse_.data());
  };
  const Totals totals = again();
  if (!totals.stale) return totals;
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
  return again();
}

// How many tokens may be drawn before the denominators are worked out anew; 0: one, by drawOne().
int32_t Gibbs::blockLength(const Totals& totals) const {
  if (one_by_one_ || (totals.confined && !table_.all_eligible)) return 0;
  const float length = kMaxStaleness / totals.max_inverse;
  return length < kMaxBlock ? static_cast<int32_t>(length) : kMaxBlock;
}

void Gibbs::drawBlock(int32_t num_running, int32_t num_rounds) {
  const int32_t opening = drawRounds(table(), inverse_.data(), chains_.data(), num_running, num_rounds);
  if (opening >= 0) openTopic(chains_[static_cast<size_t>(opening)]);
}

// The next token of the first chain, all counts exact. After refreshAll().
void Gibbs::drawOne() {
  Chain& chain = chains_[0];
  const int32_t own = chain.tokens[chain.next].slot;
  const double opening_mass = table_.opening_mass;
  bool stays_if_opening = false;
  if (own >= 0) {
    const auto k = static_cast<size_t>(own);
    const int32_t others = topic_counts_[k] - 1;
    inverse_[k] = 1.0F / (static_cast<float>(others) + table_.beta_sum);
    stays_if_opening = others == 0 && hyperparameters_.gamma > 0.0;
    if (stays_if_opening) {
      // Without this word the topic is unused, and there is one unused option: its own slot.
      inverse_[k] = 0.0F;
      table_.opening_mass = hyperparameters_.gamma * hyperparameters_.alpha / vocabulary_size_;
    }
  }
  const int32_t opening = drawRounds(table_, inverse_.data(), chains_.data(), 1, 1);
  table_.opening_mass = opening_mass;
  if (opening < 0) return;
  if (stays_if_opening) {
    ++chain.next;
  } else {
    openTopic(chain);
  }
}

void Gibbs::openTopic(Chain& chain) {
  Token& token = chain.tokens[chain.next++];
  if (token.slot >= 0) {
    --row(token.word)[token.slot];
    --chain.counts[token.slot];
  }
  token.slot = slots_.firstClosed();
  ++row(token.word)[token.slot];
  ++chain.counts[token.slot];
}

void Gibbs::leave() {
  int32_t num_left = 0;
  for (int32_t j = 0; j < num_chains_; ++j) {
    Chain& chain = chains_[static_cast<size_t>(j)];
    if (chain.next < chain.size) {
      if (num_left < j) std::swap(chains_[static_cast<size_t>(num_left)], chain);
      ++num_left;
    } else {
      for (size_t k = 0; k < outside_.size(); ++k) outside_[k] += chain.counts[k];
    }
  }
  num_chains_ = num_left;
}

}  // namespace shoal::topics
