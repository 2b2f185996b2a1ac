// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shoal/world/words_in_cells.h"

namespace shoal::topics {

/// How often each label has each word, and how well a cell's words fit each label.
///
/// Every group of words is a multinomial of its own, with prior beta:
///
///     phi_gk(w) = (n_gk(w) + beta) / (n_gk + V_g beta)
///
/// The logarithms stand beside the counts and change with them, so that reading is addition only. Counts are
/// exact, logarithms integers (fixed_log.h).
///
/// Memory: V x K x 8 bytes.
class LabelCounts {
 public:
  /// @param groups  Together they tile [0, vocabulary size).
  /// @param beta    In steps of 1/256, at least one.
  /// @throws std::invalid_argument for groups that do not, or a table of more than 2^31 entries.
  LabelCounts(std::vector<world::WordGroup> groups, int32_t num_labels, double beta);

  const std::vector<world::WordGroup>& groups() const { return groups_; }
  int32_t vocabularySize() const { return groups_.back().first + groups_.back().size; }

  /// Length of every row over labels: their number rounded up to whole vector registers. The labels beyond
  /// never have words.
  int32_t stride() const { return stride_; }

  /// `words` ascend, each once, as in WordsInCells.
  void add(std::span<const world::WordCount> words, int32_t label) { change(words, label, 1); }
  void remove(std::span<const world::WordCount> words, int32_t label) { change(words, label, -1); }

  /// log2 of prod_w phi_gk(w)^count for every label k, in units of 2^-16.
  /// @param own     Label whose counts hold these words: they are taken out for it. -1: none does.
  /// @param scores  stride() long.
  /// Cost: words x K multiply-adds.
  void logLikelihoods(std::span<const world::WordCount> words, int32_t own, std::span<int64_t> scores) const;

  /// n_gk(w) for all labels, stride() long.
  std::span<const int32_t> wordCounts(int32_t word) const;

 private:
  void change(std::span<const world::WordCount> words, int32_t label, int32_t sign);
  uint32_t logOf(int64_t count, int64_t prior) const;
  size_t at(int32_t row, int32_t label) const {
    return static_cast<size_t>(row) * static_cast<size_t>(stride_) + static_cast<size_t>(label);
  }

  const std::vector<world::WordGroup> groups_;
  const int32_t stride_;
  const int64_t prior_;                // beta, in units of 1/256
  std::vector<uint32_t> log_of_;       // log2(count + beta) of small counts
  std::vector<int32_t> counts_;        // n_gk(w), word-major: V rows of stride_
  std::vector<uint32_t> logs_;         // of counts_ + beta
  std::vector<int64_t> group_counts_;  // n_gk, a row a group
  std::vector<uint32_t> group_logs_;   // of group_counts_ + V_g beta
};

}  // namespace shoal::topics
