// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shoal/topics/label_conditional.h"
#include "shoal/topics/neighborhood.h"

namespace shoal::topics {

/// How well the words of cells fit labels, cell by cell.
struct LabelLikelihoods {
  int32_t num_labels = 0;                ///< > 0
  std::vector<int64_t> log_likelihoods;  ///< log2 of them, in units of 2^-16: a row of num_labels a cell
  std::vector<int64_t> num_words;        ///< of each cell, > 0

  std::span<const int64_t> of(int32_t cell) const {
    return std::span(log_likelihoods)
        .subspan(static_cast<size_t>(cell) * static_cast<size_t>(num_labels),
                 static_cast<size_t>(num_labels));
  }
};

/// The likeliest label of every cell by the conditional of label_conditional.h: first by its words alone,
/// then `rounds` times, cell after cell, with the votes of its neighbours as they are labelled by then; fewer
/// when nothing changes any more (iterated conditional modes, Besag 1986). Ties go to the lowest label.
/// @param neighborhood  of the same cells.
/// Cost: labels x cells a round.
std::vector<int32_t> likeliestLabels(const LabelLikelihoods& likelihoods, const Neighborhood& neighborhood,
                                     const ConditionalScale& scale, int rounds);

}  // namespace shoal::topics
