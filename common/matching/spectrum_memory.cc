// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/spectrum_memory.h"

#include <algorithm>
#include <bit>
#include <iterator>
#include <span>
#include <utility>

#include "shoal/demand.h"
#include "shoal/random.h"

namespace shoal::matching {
namespace {

template <class T>
bool areSame(std::span<const T> a, const std::vector<T>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

}  // namespace

Eigenpairs SpectrumMemory::remember(const Eigen::SparseMatrix<double>& block, double bound,
                                    const std::function<Eigenpairs()>& solve) {
  SHOAL_DEMAND(block.isCompressed());
  const auto count = static_cast<size_t>(block.nonZeros());
  const std::span<const int> first(block.outerIndexPtr(), static_cast<size_t>(block.cols()) + 1);
  const std::span<const int> row(block.innerIndexPtr(), count);
  const std::span<const double> value(block.valuePtr(), count);
  uint64_t hash = hashCombine(count, std::bit_cast<uint64_t>(bound));
  for (const int r : row) hash = mix64(hash ^ static_cast<uint64_t>(r));
  for (const double v : value) hash = mix64(hash ^ std::bit_cast<uint64_t>(v));
  const auto [begin, end] = known_.equal_range(hash);
  for (auto at = begin; at != end; ++at) {
    Known& known = at->second;
    if (known.bound == bound && areSame(first, known.first) && areSame(row, known.row) &&
        areSame(value, known.value)) {
      known.used = true;
      return known.pairs;
    }
  }
  ++num_solved_;
  Eigenpairs pairs = solve();
  known_.emplace(hash, Known{bound,
                             {first.begin(), first.end()},
                             {row.begin(), row.end()},
                             {value.begin(), value.end()},
                             pairs,
                             true});
  return pairs;
}

void SpectrumMemory::forgetUnused() {
  for (auto at = known_.begin(); at != known_.end();)
    at = std::exchange(at->second.used, false) ? std::next(at) : known_.erase(at);
}

}  // namespace shoal::matching
