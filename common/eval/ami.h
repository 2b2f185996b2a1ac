// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "shoal/eval/contingency.h"

namespace shoal::eval {

/// Adjusted mutual information, (MI - E[MI]) / (max(H_label, H_truth) - E[MI]).
///
/// 1 for labellings that group the cells alike, about 0 for independent ones, possibly negative. Names do not
/// matter. 1 if both labellings are constant; 0 where the quotient is 0/0 otherwise (all cells alone in both
/// labellings), and 0 without any cells: nothing was shown then (scikit-learn says 1).
///
/// Cost: O(labels × classes × spread of the counts). Source: Jamieson et al. 2021, §V; N. X. Vinh, J. Epps,
/// J. Bailey, ICML 2009. Natural logarithms throughout this file.
double ami(const Contingency& table);

/// Normalised mutual information, MI / max(H_label, H_truth), in [0, 1]. 1 if both labellings are constant,
/// 0 without any cells.
double nmi(const Contingency& table);

/// Mutual information of the labelling and the truth, in nats, >= 0.
double mutualInformation(const Contingency& table);

/// The mean of mutualInformation() over all permutations of the cells: exact, the sum over the hypergeometric
/// distribution of every pair of margins, up to terms below 1e-20 of the greatest.
double expectedMutualInformation(const Contingency& table);

/// Entropy of a labelling with these counts, in nats.
double entropy(const std::vector<int64_t>& cells);

}  // namespace shoal::eval
