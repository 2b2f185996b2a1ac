// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "shoal/matching/descriptors.h"

namespace shoal::matching {

/// All pairs i < j of topics with words for which reaches(cosine(i, j), sigma), ascending: exactly what
/// comparing all pairs finds, but by an inverted index.
///
/// A topic's most widespread words are left aside as long as what they weigh, in the norm, is below sigma: a
/// topic that is so much alike must share one of the others. So only these look up earlier topics, and the
/// dot product is completed only for those that can still reach sigma, by the bound of Cauchy and Schwarz on
/// what both have in the words left aside. Products are doubles; a pair within 1e-8 of sigma, far more than
/// their round-off, is decided by cosine() itself.
///
/// @param topics  their number is n; each valid, see check(). An empty topic has no pairs.
/// @param sigma   in (0, 1].
/// Cost: per topic the topics that share each of its words looked up.
/// Memory: the words of all topics.
/// Source: the prefix filter of R. Bayardo, Y. Ma and R. Srikant, Scaling up all pairs similarity search,
/// WWW 2007.
std::vector<std::pair<int, int>> cosineNeighbours(const std::vector<const Descriptor*>& topics, double sigma);

/// Those of the same pairs that have a topic of `chosen` in them, each once, in any order: these are compared
/// with all others, in doubles, and by cosine() itself within 1e-8 of sigma.
/// @param chosen  places among `topics`, each once.
/// Cost: O(words of all topics) for each of the chosen.
std::vector<std::pair<int, int>> cosineNeighboursOf(const std::vector<const Descriptor*>& topics,
                                                    const std::vector<int>& chosen, double sigma);

}  // namespace shoal::matching
