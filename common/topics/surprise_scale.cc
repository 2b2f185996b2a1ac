// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/surprise_scale.h"

#include <algorithm>
#include <utility>

#include "shoal/demand.h"

namespace shoal::topics {
namespace {

constexpr double kStepsPerBit = 64;
constexpr size_t kMostSteps = 64 * 64;

size_t stepOf(double bits) {
  SHOAL_DEMAND(bits >= 0);
  return static_cast<size_t>(std::min(bits * kStepsPerBit, static_cast<double>(kMostSteps - 1)));
}

}  // namespace

void SurpriseScale::add(double bits) {
  const size_t step = stepOf(bits);
  if (counts_.size() <= step) counts_.resize(step + 1);
  ++counts_[step];
  ++num_cells_;
}

std::vector<float> SurpriseScale::of(std::span<const double> bits) const {
  std::vector<float> scaled(bits.size());
  if (num_cells_ < kFewestCells) return scaled;
  size_t median = 0, high = 0;
  int64_t below = 0;
  for (size_t step = 0; step < counts_.size(); ++step) {
    if (2 * below < num_cells_) median = step;
    if (10 * below < 9 * num_cells_) high = step;
    below += counts_[step];
  }
  const double spread = static_cast<double>(std::max<size_t>(high - median, 1));
  for (size_t i = 0; i < bits.size(); ++i) {
    const double above = static_cast<double>(stepOf(bits[i])) - static_cast<double>(median);
    scaled[i] = static_cast<float>(std::max(0.0, above / spread));
  }
  return scaled;
}

bool SurpriseScale::restore(std::vector<int32_t> counts) {
  if (counts.size() > kMostSteps || (!counts.empty() && counts.back() <= 0)) return false;
  int64_t cells = 0;
  for (const int32_t count : counts) {
    if (count < 0) return false;
    cells += count;
  }
  counts_ = std::move(counts);
  num_cells_ = cells;
  return true;
}

}  // namespace shoal::topics
