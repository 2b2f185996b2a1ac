// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

namespace shoal::topics {

/// What a cell's words are compared with: the labels of the whole map, so that rare terrain stands out, or
/// those around the cell, so that only what does not belong there does.
enum class Surroundings { kGlobal, kNeighborhood };

/// How badly the labels around explain a cell's words, in bits per word: log2 of the perplexity
///
///     -1/n log2 Σ_k π_k L_k,    π_k = cells_of_label[k] / Σ_j cells_of_label[j].
///
/// @param log_likelihoods  log2 L_k of the words, in units of 2^-16.
/// @param cells_of_label   As long; >= 0, one of them at least > 0, their sum below 2^31.
/// @param num_words        n > 0.
/// Integers but for the last division: the same on every machine.
double bitsPerWord(std::span<const int64_t> log_likelihoods, std::span<const int32_t> cells_of_label,
                   int64_t num_words);

}  // namespace shoal::topics
