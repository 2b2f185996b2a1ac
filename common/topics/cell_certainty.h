// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace shoal::topics {

/// How sure a cell's label is: the share of cells like it that were right in places with known truth, a topic
/// being right where it has its majority class,
///
///     c = 1 / (1 + 2^-x),    x = offset + slope ((2 log2 L_own - log2 L_other) / n + w),
///
/// with L_own, L_other the likelihoods of the cell's n words under its topic and under the best other one,
/// and w the mean of log2 of the sizes of the word groups. So there speak the lead over the next topic, and
/// how much better than chance the words are explained at all; each of them in bits per word. The posterior
/// mass of the label itself ranks errors worse, since most of the cells that are wrong are sure:
/// docs/labels.md.
///
/// Integers but for the last division: the same on every machine.
/// @param log_own, log_other  log2 of the likelihoods, in units of 2^-16, <= 0.
/// @param num_words           n > 0.
/// @param log_group_size      w, in units of 2^-16, >= 0.
float cellCertainty(int64_t log_own, int64_t log_other, int64_t num_words, int64_t log_group_size);

}  // namespace shoal::topics
