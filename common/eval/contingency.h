// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace shoal::eval {

/// How often each label meets each true class.
struct Contingency {
  struct Count {
    int label = 0;      ///< index into label_ids
    int truth = 0;      ///< index into truth_ids
    int64_t cells = 0;  ///< > 0
    bool operator==(const Count&) const = default;
  };
  std::vector<int> label_ids;        ///< ascending
  std::vector<int> truth_ids;        ///< ascending
  std::vector<int64_t> label_cells;  ///< cells of each label
  std::vector<int64_t> truth_cells;  ///< cells of each class
  std::vector<Count> counts;         ///< the pairs that occur, by label, then truth
  int64_t num_cells = 0;
};

/// Counts the pairs of two labellings of the same cells.
///
/// @param label, truth  one id per cell, any numbers.
/// @throws std::invalid_argument if they differ in length.
///
/// Cost: O(n) where the ids span few numbers (labels x classes within 2^16, rounded up to powers of two),
/// about 1 ns a cell and core; O(n log n) else. More than a million cells are counted on all cores.
Contingency contingency(std::span<const int> label, std::span<const int> truth);

}  // namespace shoal::eval
