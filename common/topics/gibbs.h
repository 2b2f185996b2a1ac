// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shoal/random.h"
#include "shoal/topics/cell_words.h"
#include "shoal/topics/hyperparameters.h"
#include "shoal/topics/topic_slots.h"

namespace shoal::topics {

/// The collapsed Gibbs step and the global counts it moves words between.
///
/// A word w of cell c gets topic k with probability
///
///     p(z = k) ∝ g_k · (n_kw + β) / (n_k + Vβ) · (N_ck + α),    N_ck = n_ck + g_σ Σ_neighbours n_gk,
///
/// all counts without the word itself: only its own topic's are decremented. g_k is 1 for a topic that has
/// words, γ for one unused slot, 0 for the other unused ones; with γ = 0 it is 1 for all K, and K is fixed.
/// A word that is the last of its topic counts its own slot as the unused one, so it may stay and keep the
/// topic's id. The very first word has no other
/// choice than the first slot, however small γ. Once the ids have run out nothing new opens.
///
/// Numbers: double throughout, one fixed order of summation, no library functions, so any build that obeys
/// IEEE 754 (no fast-math, no contraction) gives the same bytes. A new topic may have a probability of
/// 1e-12; 53 random bits resolve it.
///
/// Cost: O(highest open slot) per word, one row of the word-major table. Memory V x K int32.
///
/// Source: topics of S. Jamieson et al. 2021, §IV-A; Y. Girdhar et al. 2016, arXiv:1509.07979. We differ
/// from the 2013 code, which subtracts the word from every topic to avoid locks.
class Gibbs {
 public:
  /// @throws std::invalid_argument if a hyperparameter is out of range, vocabulary_size < 1, or the count
  ///         table would exceed 2^31 entries.
  Gibbs(const Hyperparameters& hyperparameters, int32_t vocabulary_size);

  /// Length of every histogram over slots: K rounded up to a whole number of vector registers. The slots
  /// from K on are never used.
  int32_t stride() const { return stride_; }

  /// Draws a first topic for each token (slot -1) from the conditional, in order.
  /// @param cell_counts      n_ck of the tokens' cell, stride() long; kept up to date.
  /// @param neighbor_counts  g_σ Σ n_gk of its neighbours, stride() long.
  void assign(std::span<Token> tokens, std::span<int32_t> cell_counts,
              std::span<const double> neighbor_counts, Random random);

  /// Takes each token out, draws its topic anew and puts it back, in order. Parameters as assign().
  void resample(std::span<Token> tokens, std::span<int32_t> cell_counts,
                std::span<const double> neighbor_counts, Random random);

  /// Adds counts that belong to no token (`sign` 1) or takes them away again (-1). Opens and closes the slot
  /// as words do.
  void addCounts(int32_t slot, std::span<const world::WordCount> words, int sign);

  /// Makes a fresh table's topics what others were: names and places, to which addCounts() then gives the
  /// words. As TopicSlots::restore().
  void restoreTopics(int32_t num_ids_used, std::span<const TopicSlots::Named> open) {
    slots_.restore(num_ids_used, open);
  }

  int32_t vocabularySize() const { return vocabulary_size_; }
  const TopicSlots& slots() const { return slots_; }
  void nameTopics(world::Timestamp now) { slots_.nameTopics(now); }

  /// n_kw of one word for all slots, stride() long.
  std::span<const int32_t> wordCounts(int32_t word) const;
  /// n_k
  int64_t topicCount(int32_t slot) const { return topic_counts_[static_cast<size_t>(slot)]; }

 private:
  void enter(std::span<const int32_t> cell_counts, std::span<const double> neighbor_counts);
  void weigh(const int32_t* row);
  int32_t draw(double uniform);
  void put(const Token& token, std::span<int32_t> cell_counts, std::span<const double> neighbor_counts);
  void take(int32_t word, int32_t slot, std::span<int32_t> cell_counts,
            std::span<const double> neighbor_counts);
  void updateFactors(int32_t slot, int32_t cell_count, double neighbor_count);
  double openness(int32_t slot) const;
  int32_t* row(int32_t word) { return word_counts_.data() + static_cast<ptrdiff_t>(word) * stride_; }

  const Hyperparameters hyperparameters_;
  const int32_t vocabulary_size_;
  const int32_t stride_;
  const double beta_sum_;  // Vβ
  TopicSlots slots_;
  std::vector<int32_t> word_counts_;   // n_kw, word-major: V rows of stride_
  std::vector<int64_t> topic_counts_;  // n_k
  std::vector<double> inverse_;        // 1 / (n_k + Vβ)
  std::vector<double> inverse_less_;   // 1 / (n_k - 1 + Vβ), for a word's own topic

  // Of the cell being visited; 0 outside the slots that may be drawn.
  int32_t width_ = 0;                // slots looped over, a multiple of 4
  std::vector<double> factor_;       // g_k (N_ck + α) / (n_k + Vβ)
  std::vector<double> factor_less_;  // (N_ck - 1 + α) / (n_k - 1 + Vβ)
  std::vector<double> weight_;       // of one word
};

}  // namespace shoal::topics
