// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shoal/random.h"
#include "shoal/topics/aligned.h"
#include "shoal/topics/cell_words.h"
#include "shoal/topics/gibbs_kernel.h"
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
/// topic's id. The very first word has no other choice than the first slot, however small γ. Once the ids
/// have run out nothing new opens.
///
/// The order of draws: up to kLanes cells are entered at once, none of which may adjoin another, and their
/// words are drawn in rounds, one of each cell side by side, each from n_kw and n_ck as they were before the
/// round. n_k in the denominator is worked out anew before the words drawn since are more than a 16th of any
/// n_k + Vβ, or, if that is more, a 256th of all words; no round has more words than that either. Where this
/// allows but one word, and where a topic might close or the ids run out, words are drawn one by one with
/// everything exact. A topic that empties meanwhile and gets words again has never been gone.
///
/// Whether a topic opens is drawn apart, with 48 random bits: its probability may be 1e-12. Which of the open
/// ones it is, is drawn with 23 bits. All in float, in one fixed order of summation. No library functions:
/// any build that obeys IEEE 754 (no fast-math, no contraction), with any instruction set, gives the same
/// bytes.
///
/// Cost: O(K) per word, one row of the word-major table. Memory V x K int32.
///
/// Source: topics of S. Jamieson et al. 2021, §IV-A; Y. Girdhar et al. 2016, arXiv:1509.07979. We differ
/// from the 2013 code, which subtracts the word from every topic to avoid locks.
class Gibbs {
 public:
  /// @throws std::invalid_argument if a hyperparameter is out of range, vocabulary_size < 1, or the count
  ///         table would exceed 2^31 entries.
  Gibbs(const Hyperparameters& hyperparameters, int32_t vocabulary_size);

  /// Length of every histogram over slots: K rounded up to a multiple of kSlotsTogether. The slots from K on
  /// are never used.
  int32_t stride() const { return table_.stride; }

  /// Enters a cell whose tokens are to be drawn anew; those of slot -1 have no topic yet. Fewer than
  /// kLanes cells may be entered. Tokens and counts must stay where they are until the cell has left.
  /// @param cell             Its name in entered().
  /// @param cell_counts      n_ck of all the cell's tokens, stride() long; up to date when it has left.
  /// @param neighbor_counts  g_σ Σ n_gk of its neighbours, stride() long; copied.
  void enter(int32_t cell, std::span<Token> tokens, std::span<int32_t> cell_counts,
             std::span<const float> neighbor_counts, Random random);

  int32_t numEntered() const { return num_entered_; }
  int32_t numLeft() const { return num_left_; }
  /// The cells that left in the last advance().
  int32_t left(int32_t i) const { return left_[static_cast<size_t>(i)]; }

  /// Draws some words of each. Cells whose tokens are all drawn have left afterwards. At least one must be
  /// entered.
  void advance();

  /// enter() and advance() of a cell alone.
  void resample(std::span<Token> tokens, std::span<int32_t> cell_counts,
                std::span<const float> neighbor_counts, Random random);

  /// Adds counts that belong to no token (`sign` 1) or takes them away again (-1). Opens and closes the slot
  /// as words do. No cell may be entered.
  void addCounts(int32_t slot, std::span<const world::WordCount> words, int sign);

  /// Makes a fresh table's topics what others were: names and places, to which addCounts() then gives the
  /// words. As TopicSlots::restore().
  void restoreTopics(int32_t num_ids_used, std::span<const TopicSlots::Named> open);

  int32_t vocabularySize() const { return vocabulary_size_; }
  const TopicSlots& slots() const { return slots_; }
  void nameTopics(world::Timestamp now) { slots_.nameTopics(now); }

  /// n_kw of one word for all slots, stride() long.
  std::span<const int32_t> wordCounts(int32_t word) const;
  /// n_k. No cell may be entered.
  int64_t topicCount(int32_t slot) const { return outside_[static_cast<size_t>(slot)]; }

 private:
  // A cell that is entered.
  struct Visit {
    int32_t cell = -1;  // its name for the caller
    int32_t lane = 0;
    int32_t* counts = nullptr;
  };

  // What the kernel reads. Its pointers lead into the members below and are set before each use.
  const Table& table();
  void noteSlots();
  void refreshAll();
  bool isConfined(int32_t num_running) const;
  void drawTogether(int32_t num_running);
  void drawOne();
  void openTopic(int32_t lane);
  void leave();
  int32_t* row(int32_t word) { return word_counts_.data() + static_cast<ptrdiff_t>(word) * stride(); }

  const Hyperparameters hyperparameters_;
  const int32_t vocabulary_size_;
  TopicSlots slots_;
  Table table_;
  AlignedVector<int32_t> word_counts_;   // n_kw, word-major: V rows of stride()
  AlignedVector<int32_t> outside_;       // n_k without the words of the cells entered
  AlignedVector<int32_t> topic_counts_;  // n_k when last worked out
  AlignedVector<int32_t> open_;          // -1: the slot has a topic
  AlignedVector<float> eligible_;        // 1: the slot may be drawn
  AlignedVector<float> inverse_;         // 1 / (n_k + Vβ), 0 where it may not
  double opening_mass_ = 0;              // γ α / V
  bool one_by_one_ = false;              // what opens or closes meanwhile would matter
  int32_t may_draw_ = 0;                 // how many words may be drawn from one n_k
  int32_t num_drawn_ = 0;                // how many have been

  Lanes lanes_;
  std::array<Visit, kLanes> visits_;          // those entered, oldest first
  std::array<int32_t, kLanes> running_ = {};  // their lanes, then the free ones
  int32_t num_entered_ = 0;
  std::array<int32_t, kLanes> left_ = {};
  int32_t num_left_ = 0;
};

}  // namespace shoal::topics
