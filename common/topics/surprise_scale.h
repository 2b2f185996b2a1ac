// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace shoal::topics {

/// How unusual a surprise is to one robot: bits per word depend on place and camera, so a cell is compared
/// with all the others that the robot ever saw for the first time,
///
///     s = (bits - median) / (90th percentile - median),
///
/// so that 1 is what one cell in ten exceeds. Both are exact to 1/64 bit. Integers but for the last division:
/// the same on every machine.
///
/// Chosen among the bits themselves, their rank, and deviations from the median in units of the median one:
/// as good as the rank at telling cells of a class that its robot has not met (docs/labels.md), and not
/// bounded.
class SurpriseScale {
 public:
  /// Before so many cells nothing is unusual.
  static constexpr int64_t kFewestCells = 200;

  /// A cell was seen for the first time. @param bits  bitsPerWord(), >= 0.
  void add(double bits);

  /// s for each of these bits, 0 where it is negative or too little was seen.
  std::vector<float> of(std::span<const double> bits) const;

  /// Cells by their bits in steps of 1/64; what is above the last step counts as the last.
  const std::vector<int32_t>& counts() const { return counts_; }
  /// A scale with these counts, as counts() gave them. @returns false, unchanged, when they are not.
  bool restore(std::vector<int32_t> counts);

 private:
  std::vector<int32_t> counts_;  // up to the highest step that was met
  int64_t num_cells_ = 0;
};

}  // namespace shoal::topics
