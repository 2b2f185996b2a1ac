// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/contingency.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace shoal::eval {
namespace {

constexpr int64_t kSmallTable = int64_t{1} << 20;

// The distinct ids of a labelling, and where each stands among them.
class Index {
 public:
  explicit Index(std::span<const int> ids) {
    if (ids.empty()) return;
    int least = ids.front();
    int greatest = ids.front();
    for (const int id : ids) {
      least = std::min(least, id);
      greatest = std::max(greatest, id);
    }
    lowest_ = least;
    const int64_t width = int64_t{greatest} - lowest_ + 1;
    if (width <= std::max(kSmallTable, static_cast<int64_t>(ids.size()))) {
      table_.assign(static_cast<size_t>(width), -1);
      int previous = least;
      table_[0] = 0;
      for (const int id : ids) {
        if (id != previous) table_[offset(id)] = 0;
        previous = id;
      }
      for (size_t k = 0; k < table_.size(); ++k) {
        if (table_[k] < 0) continue;
        table_[k] = static_cast<int>(distinct_.size());
        distinct_.push_back(static_cast<int>(lowest_ + static_cast<int64_t>(k)));
      }
    } else {
      distinct_.assign(ids.begin(), ids.end());
      std::sort(distinct_.begin(), distinct_.end());
      distinct_.erase(std::unique(distinct_.begin(), distinct_.end()), distinct_.end());
    }
  }

  const std::vector<int>& distinct() const { return distinct_; }

  size_t of(int id) const {
    if (!table_.empty()) return static_cast<size_t>(table_[offset(id)]);
    return static_cast<size_t>(std::lower_bound(distinct_.begin(), distinct_.end(), id) - distinct_.begin());
  }

 private:
  size_t offset(int id) const { return static_cast<size_t>(int64_t{id} - lowest_); }

  int64_t lowest_ = 0;
  std::vector<int> table_;
  std::vector<int> distinct_;
};

}  // namespace

Contingency contingency(std::span<const int> label, std::span<const int> truth) {
  if (label.size() != truth.size()) {
    throw std::invalid_argument("two labellings of the same cells must be equally long, got " +
                                std::to_string(label.size()) + " and " + std::to_string(truth.size()));
  }
  const Index labels(label);
  const Index truths(truth);
  const size_t num_truths = truths.distinct().size();
  Contingency result;
  result.label_ids = labels.distinct();
  result.truth_ids = truths.distinct();
  result.label_cells.assign(labels.distinct().size(), 0);
  result.truth_cells.assign(num_truths, 0);
  result.num_cells = static_cast<int64_t>(label.size());

  const auto add = [&](size_t cell, int64_t cells) {
    const Contingency::Count count{static_cast<int>(cell / num_truths), static_cast<int>(cell % num_truths),
                                   cells};
    result.counts.push_back(count);
    result.label_cells[static_cast<size_t>(count.label)] += cells;
    result.truth_cells[static_cast<size_t>(count.truth)] += cells;
  };
  const auto cellOf = [&](size_t n) { return labels.of(label[n]) * num_truths + truths.of(truth[n]); };

  const size_t table_size = labels.distinct().size() * num_truths;
  if (table_size <= static_cast<size_t>(kSmallTable)) {
    std::vector<int64_t> table(table_size, 0);
    for (size_t n = 0; n < label.size(); ++n) ++table[cellOf(n)];
    for (size_t cell = 0; cell < table_size; ++cell) {
      if (table[cell] > 0) add(cell, table[cell]);
    }
    return result;
  }
  std::vector<size_t> cells(label.size());
  for (size_t n = 0; n < label.size(); ++n) cells[n] = cellOf(n);
  std::sort(cells.begin(), cells.end());
  for (size_t n = 0; n < cells.size();) {
    const size_t first = n;
    while (n < cells.size() && cells[n] == cells[first]) ++n;
    add(cells[first], static_cast<int64_t>(n - first));
  }
  return result;
}

}  // namespace shoal::eval
