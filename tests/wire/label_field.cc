// SPDX-License-Identifier: BSD-3-Clause
#include "label_field.h"

#include <algorithm>

#include "shoal/random.h"

namespace shoal::wire {
namespace {

constexpr int kSweeps = 100;  // until about 7 % of neighbours are unlike

// How many of a cell's eight neighbours have each label.
std::vector<int> votesAround(const std::vector<int>& field, int side, int x, int y, int num_labels) {
  std::vector<int> votes(static_cast<size_t>(num_labels));
  for (int i = std::max(x - 1, 0); i <= std::min(x + 1, side - 1); ++i)
    for (int j = std::max(y - 1, 0); j <= std::min(y + 1, side - 1); ++j)
      if (i != x || j != y) ++votes[static_cast<size_t>(field[static_cast<size_t>(i * side + j)])];
  return votes;
}

}  // namespace

std::vector<int> labelField(int side, int num_labels, double speckle) {
  Random random(20210529);
  const auto below = [&](int n) { return static_cast<int>(random.below(static_cast<uint64_t>(n))); };
  std::vector<int> field(static_cast<size_t>(side * side));
  for (int& label : field) label = below(num_labels);
  for (int step = 0; step < kSweeps * side * side; ++step) {
    const int x = below(side), y = below(side);
    const std::vector<int> votes = votesAround(field, side, x, y, num_labels);
    int& label = field[static_cast<size_t>(x * side + y)];
    const int most = *std::ranges::max_element(votes);
    int ties = 0;
    for (int l = 0; l < num_labels; ++l)
      if (votes[static_cast<size_t>(l)] == most && below(++ties) == 0) label = l;
  }
  for (int& label : field)
    if (random.uniform() < speckle) label = below(num_labels);
  return field;
}

}  // namespace shoal::wire
