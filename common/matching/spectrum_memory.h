// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/SparseCore>
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

#include "shoal/matching/eigenpairs.h"

namespace shoal::matching {

/// Eigenpairs of components that were solved before. A component is looked up by all of its content: the same
/// block and bound have the same eigenpairs, to the bit, since solving is a pure function of them. So memory
/// saves time and changes no answer.
class SpectrumMemory {
 public:
  /// What `solve` makes of the block, unless it is known.
  /// @param block  symmetric, compressed.
  /// Cost: O(entries) when it is known. Memory: the block and its pairs.
  Eigenpairs remember(const Eigen::SparseMatrix<double>& block, double bound,
                      const std::function<Eigenpairs()>& solve);

  /// Forgets what was not asked for since the last call: what is kept is what one matching needs.
  void forgetUnused();

  int64_t numSolved() const { return num_solved_; }  ///< blocks that were not known, so far

 private:
  struct Known {
    double bound;
    std::vector<int> first, row;
    std::vector<double> value;
    Eigenpairs pairs;
    bool used;
  };
  std::unordered_multimap<uint64_t, Known> known_;  // by a hash of the content; looked up only
  int64_t num_solved_ = 0;
};

}  // namespace shoal::matching
