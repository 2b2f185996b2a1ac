// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "shoal/topics/label_conditional.h"
#include "shoal/topics/neighborhood.h"

namespace shoal::topics {

/// The labels that each cell may turn out to have, by how well its words fit them: those that could be the
/// likeliest with all votes of its neighbours, and no more, for there are few. The two that the words fit
/// best are always there.
class LabelCandidates {
 public:
  struct Candidate {
    int32_t label = 0;
    int64_t log_likelihood = 0;  ///< log2, in units of 2^-16
    int64_t weight = 0;          ///< of it by the conditional, and of what else speaks for the label
  };

  /// @param neighborhood  of the cells that will be added; outlives this.
  LabelCandidates(const Neighborhood& neighborhood, const ConditionalScale& scale)
      : neighborhood_(neighborhood), scale_(scale) {}

  /// The next cell, in order of the neighbourhood's numbers.
  /// @param log_likelihoods  log2 for each label, in units of 2^-16: as many labels as the first cell has, >
  /// 0.
  /// @param num_words        of the cell, > 0.
  /// @param in_favour        of each label, what else speaks for it: log2 in units of 2^-16.
  void add(std::span<const int64_t> log_likelihoods, int64_t num_words, std::span<const int64_t> in_favour);

  /// Ascending by label, never empty.
  std::span<const Candidate> of(int32_t cell) const {
    const auto first = first_[static_cast<size_t>(cell)];
    return std::span(candidates_).subspan(first, first_[static_cast<size_t>(cell) + 1] - first);
  }
  int32_t numCells() const { return static_cast<int32_t>(first_.size()) - 1; }
  int32_t numLabels() const { return num_labels_; }
  const Neighborhood& neighborhood() const { return neighborhood_; }
  const ConditionalScale& scale() const { return scale_; }

 private:
  const Neighborhood& neighborhood_;
  const ConditionalScale scale_;
  int32_t num_labels_ = 0;
  std::vector<size_t> first_ = {0};  // of each cell's; one more
  std::vector<Candidate> candidates_;
  std::vector<int64_t> weights_;
};

/// The likeliest label of every cell by the conditional of label_conditional.h: first without its neighbours,
/// then `rounds` times, cell after cell, with the votes of its neighbours as they are labelled by then; fewer
/// when nothing changes any more (iterated conditional modes, Besag 1986). Ties go to the lowest label.
/// @param candidates  of all cells of the neighbourhood.
/// @param breathe     Called every few thousand cells.
/// Cost: candidates a round.
std::vector<int32_t> likeliestLabels(const LabelCandidates& candidates, int rounds,
                                     const std::function<void()>& breathe);

}  // namespace shoal::topics
