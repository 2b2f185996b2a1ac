// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace shoal::eval {

/// One knob to be tuned, searched between two positive numbers on a logarithmic scale.
struct Knob {
  std::string name;
  double low = 0, high = 0;  ///< 0 < low < high
};

/// A setting that was tried and what it scored.
struct Tried {
  std::vector<double> values;  ///< one a knob
  double score = 0;            ///< finite; more is better
};

/// Bayesian optimisation of a noisy score: the first `random` settings are drawn from a scrambled lattice
/// that covers the space, each further one is the best of a thousand candidates by the upper confidence bound
/// (kappa = 2) of a Gaussian process with a Matérn 5/2 kernel, whose width and noise are chosen by marginal
/// likelihood: what the paper's authors did (Jamieson et al. 2021, §V, after Cully et al. 2018).
///
/// A pure function of its arguments.
/// @param tried  all settings so far, in order.
/// @throws std::invalid_argument for a knob without a range or a setting of another length.
/// Cost: O(n³) in the number of settings tried; 20 ms at 100.
std::vector<double> nextSetting(const std::vector<Knob>& knobs, const std::vector<Tried>& tried, int random,
                                uint64_t seed);

/// The setting whose score the Gaussian process expects most of, among those tried: one lucky run does not
/// win.
/// @throws std::invalid_argument when nothing was tried.
size_t bestSetting(const std::vector<Knob>& knobs, const std::vector<Tried>& tried);

}  // namespace shoal::eval
