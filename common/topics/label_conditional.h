// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "shoal/random.h"

namespace shoal::topics {

/// How strongly words and neighbours speak for a label, as integers so that every machine draws the same.
struct ConditionalScale {
  int64_t evidence = 0;  ///< e, in units of 2^-16
  int64_t coupling = 0;  ///< J / ln 2, in units of 2^-16

  /// @param evidence  e in [0, 1e6].
  /// @param coupling  J in [0, 100], natural logarithm.
  static ConditionalScale of(double evidence, double coupling);
};

/// A label that cannot be drawn: stands in place of its number of alike neighbours.
inline constexpr int32_t kNotALabel = -1;

/// The conditional of a cell's label,
///
///     p(z = k) ∝ exp(min(1, e / n) ln L_k + J m_k).
///
/// @param log_likelihoods  log2 L_k of the cell's words, in units of 2^-16.
/// @param num_words        n, how many they are, > 0.
/// @param alike            m_k, how many of its neighbours have label k; kNotALabel: p(z = k) = 0.
/// @param weights          Out: in proportion to p, the largest 2^32. 0 below 2^-33 of it.
void weighLabels(std::span<const int64_t> log_likelihoods, int64_t num_words, std::span<const int32_t> alike,
                 const ConditionalScale& scale, std::span<uint64_t> weights);

/// The likeliest label by the same conditional, ties to the lowest. One of them at least is a label.
int32_t likeliestLabel(std::span<const int64_t> log_likelihoods, int64_t num_words,
                       std::span<const int32_t> alike, const ConditionalScale& scale);

/// What the words of a cell say for a label: min(1, e / n) log2 L, in units of 2^-16, as above.
int64_t weightOfWords(int64_t log_likelihood, int64_t num_words, const ConditionalScale& scale);

/// A label drawn in proportion to its weight; one of them at least is above 0.
int32_t drawLabel(std::span<const uint64_t> weights, Random& random);

}  // namespace shoal::topics
