// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "shoal/matching/descriptors.h"
#include "shoal/matching/similarity.h"

namespace shoal::matching {

/// Which topics are alike, of the topics last asked about: when a few have changed since, only these are
/// compared anew. A similarity is a function of two topics' words, so what was found of two that are as they
/// were still holds, wherever they now stand; the answer is that of comparing all, to the pair.
class NeighbourMemory {
 public:
  /// All pairs i < j, ascending, of topics with words for which reaches(similarity(i, j), sigma).
  /// @param topics  their number is n; each valid, see check().
  /// @param sigma   in (0, 1].
  /// Cost: n comparisons for every topic that was not among the last, and O(words) to find these; when more
  /// than a third is new, what comparing all costs. Memory: the words of all topics, and the pairs.
  std::vector<std::pair<int, int>> pairs(const std::vector<const Descriptor*>& topics, Similarity similarity,
                                         double sigma);

  int64_t numCompared() const { return num_compared_; }  ///< topics that were compared anew, so far

 private:
  std::vector<int> placesBefore(const std::vector<const Descriptor*>& topics) const;
  std::vector<std::pair<int, int>> pairsOfKnown(const std::vector<int>& before) const;
  void keep(const std::vector<const Descriptor*>& topics, const std::vector<int>& before,
            const std::vector<std::pair<int, int>>& pairs);

  Similarity similarity_ = nullptr;
  double sigma_ = 0;
  std::vector<Descriptor> topics_;
  std::vector<uint64_t> hashes_;              // of their words
  std::vector<std::vector<int>> neighbours_;  // of each, ascending
  int64_t num_compared_ = 0;
};

/// The same pairs from nothing: by cosineNeighbours() for cosine(), else two by two.
std::vector<std::pair<int, int>> neighbours(const std::vector<const Descriptor*>& topics,
                                            Similarity similarity, double sigma);

}  // namespace shoal::matching
