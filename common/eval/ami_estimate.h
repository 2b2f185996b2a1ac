// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

namespace shoal::eval {

/// What a few cells, looked at by a person, say of a whole map.
struct AmiEstimate {
  double ami = 0;            ///< of the whole map, estimated
  double low = 0, high = 0;  ///< holds the whole map's in 95 of 100 such draws; in [-1, 1]
};

/// The fewest cells from which anything is estimated.
inline constexpr int64_t kFewestNamedCells = 20;

/// Estimates the AMI that all cells of a map would have from some of them, drawn at random without
/// replacement.
///
/// The jackknife: ami() without each cell in turn gives the bias (a rare label is met once or never) and the
/// variance, which shrinks to 0 as all cells are named. Where hardly a cell is off it knows nothing of those
/// that are; so the interval reaches at least to what the sample would show with three more cells that
/// disagree (rule of three: 95 % that no more than 3 of n are so). Not for cells that somebody chose.
///
/// @param label, name   of each cell that was named: its label in the map, and what it is.
/// @param cells_of_map  all cells, >= label.size().
/// @throws std::invalid_argument for fewer than kFewestNamedCells, or unequal lengths.
/// Cost: as ami(), times the pairs of label and name that occur.
/// Source: B. Efron, C. Stein, Annals of Statistics 1981; J. A. Hanley, A. Lippman-Hand, JAMA 1983. How often
/// the interval holds is measured in tests/eval/ami_estimate_test.cc.
AmiEstimate estimateAmi(std::span<const int> label, std::span<const int> name, int64_t cells_of_map);

}  // namespace shoal::eval
