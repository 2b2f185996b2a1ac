// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/ami_estimate.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "shoal/eval/ami.h"

namespace shoal::eval {
namespace {

// A sample of cells as label and name of each, in the order of the pairs that occur.
struct Sample {
  std::vector<int> label, name;

  explicit Sample(const Contingency& table) {
    for (const Contingency::Count& c : table.counts) add(c.label, c.truth, c.cells);
  }
  void add(int l, int n, int64_t cells) {
    label.insert(label.end(), static_cast<size_t>(cells), l);
    name.insert(name.end(), static_cast<size_t>(cells), n);
  }
  double ami() const { return eval::ami(contingency(label, name)); }
  double amiWithout(size_t cell) const {
    Sample less = *this;
    less.label.erase(less.label.begin() + static_cast<std::ptrdiff_t>(cell));
    less.name.erase(less.name.begin() + static_cast<std::ptrdiff_t>(cell));
    return less.ami();
  }
};

// With three more cells of the greatest label, named as what it is not.
double withThreeThatDisagree(const Contingency& table) {
  const auto greatest = std::ranges::max_element(table.label_cells) - table.label_cells.begin();
  std::vector<int64_t> named(table.truth_ids.size());
  for (const Contingency::Count& c : table.counts)
    if (c.label == greatest) named[static_cast<size_t>(c.truth)] = c.cells;
  const auto usual = std::ranges::max_element(named) - named.begin();
  int other = static_cast<int>(named.size());  // a name of its own where all cells have one
  for (size_t n = 0; n < named.size(); ++n) {
    const bool more = other == static_cast<int>(named.size()) ||
                      table.truth_cells[n] > table.truth_cells[static_cast<size_t>(other)];
    if (static_cast<std::ptrdiff_t>(n) != usual && more) other = static_cast<int>(n);
  }
  Sample sample(table);
  sample.add(static_cast<int>(greatest), other, 3);
  return sample.ami();
}

}  // namespace

AmiEstimate estimateAmi(std::span<const int> label, std::span<const int> name, int64_t cells_of_map) {
  const Contingency table = contingency(label, name);
  if (table.num_cells < kFewestNamedCells) {
    throw std::invalid_argument(std::to_string(table.num_cells) + " named cells are too few, at least " +
                                std::to_string(kFewestNamedCells) + " are needed");
  }
  const Sample sample(table);
  const double all = sample.ami();
  const auto n = static_cast<double>(table.num_cells);
  std::vector<double> without;
  double mean = 0.0;
  size_t first = 0;
  for (const Contingency::Count& c : table.counts) {
    without.push_back(sample.amiWithout(first));
    mean += without.back() * static_cast<double>(c.cells) / n;
    first += static_cast<size_t>(c.cells);
  }
  double variance = 0.0;
  for (size_t i = 0; i < without.size(); ++i) {
    const double off = without[i] - mean;
    variance += (n - 1) / n * static_cast<double>(table.counts[i].cells) * off * off;
  }
  const double unseen = std::clamp(1.0 - n / static_cast<double>(cells_of_map), 0.0, 1.0);
  const double estimate = std::clamp(all + unseen * (n - 1) * (all - mean), -1.0, 1.0);
  const double reach = 1.96 * std::sqrt(unseen * variance);
  double low = std::max(estimate - reach, -1.0);
  if (unseen > 0.0) low = std::min(low, withThreeThatDisagree(table));
  return {estimate, low, std::min(estimate + reach, 1.0)};
}

}  // namespace shoal::eval
