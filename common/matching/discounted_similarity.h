// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "shoal/demand.h"
#include "shoal/matching/descriptors.h"

namespace shoal::matching {

/// A similarity for every pair of n vertices, in whole units of 1e-9. Memory: 2 n² bytes.
class PairTable {
 public:
  explicit PairTable(int n)
      : n_(n), nano_(static_cast<size_t>(n) * static_cast<size_t>(n > 0 ? n - 1 : 0) / 2) {}

  int size() const { return n_; }
  int32_t& at(int i, int j) { return nano_[place(i, j)]; }
  int32_t at(int i, int j) const { return nano_[place(i, j)]; }

 private:
  size_t place(int i, int j) const {
    SHOAL_DEMAND(i != j && i >= 0 && j >= 0 && i < n_ && j < n_);
    const auto low = static_cast<size_t>(i < j ? i : j);
    const auto high = static_cast<size_t>(i < j ? j : i);
    return high * (high - 1) / 2 + low;
  }

  int n_;
  std::vector<int32_t> nano_;
};

/// How alike topics are in what sets them apart from the place as a whole, for all pairs: in [-1, 1] and in
/// units of 1e-9.
///
/// Each word group g of a topic becomes a distribution φ_g, and all groups count alike. The background b_g is
/// the mean of φ_g over all topics, one vote each, and the uniform distribution with a quarter of a vote, so
/// that two topics alone can be told to be alike. A group with few words says little: φ_g = (n_g + m b_g) /
/// (N_g + m) with m = 100 words. The similarity is the cosine of sqrt(φ) - sqrt(b), a Hellinger cosine from
/// which the background has been taken.
///
/// Made from integers and correctly rounded square roots and quotients only: the same on every machine and
/// in every order of the topics.
///
/// @param topics  valid: check(topics) has passed. A topic without words is the background: 0 to all others.
/// Cost: O(n² V) time and O(n V) memory for n topics of V words.
PairTable discountedSimilarity(const DescriptorSet& topics);

}  // namespace shoal::matching
