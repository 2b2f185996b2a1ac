// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/average_linkage.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

namespace shoal::matching {
namespace {

__extension__ using Wide = __int128;

constexpr int64_t kApart = std::numeric_limits<int64_t>::min();

// Clusters are named by the lowest rank among their members.
class Linkage {
 public:
  Linkage(const PairTable& similarity, std::span<const int> rank, const PairConstraints& constraints)
      : n_(similarity.size()),
        sum_(static_cast<size_t>(n_) * static_cast<size_t>(n_)),
        size_(index(n_), 1),
        best_(index(n_), -1),
        cluster_(index(n_)) {
    std::iota(cluster_.begin(), cluster_.end(), 0);
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j < i; ++j) setSum(rank[index(i)], rank[index(j)], similarity.at(i, j));
    for (const auto& [i, j] : constraints.apart) setSum(rank[index(i)], rank[index(j)], kApart);
    for (const auto& [i, j] : constraints.together) {
      const auto [a, b] = std::minmax(cluster_[index(rank[index(i)])], cluster_[index(rank[index(j)])]);
      if (a == b) continue;
      if (sum(a, b) == kApart) {
        throw std::invalid_argument("labels " + std::to_string(i) + " and " + std::to_string(j) +
                                    " are to be both together and apart");
      }
      join(a, b);
    }
    for (int a = 0; a < n_; ++a)
      if (size_[index(a)] > 0) findBest(a);
  }

  void joinWhileAtLeast(int64_t sigma_nano) {
    while (true) {
      int a = -1;
      for (int c = 0; c < n_; ++c) {
        if (size_[index(c)] > 0 && best_[index(c)] >= 0 &&
            (a < 0 || isBefore(c, best_[index(c)], a, best_[index(a)])))
          a = c;
      }
      if (a < 0) return;
      const int b = best_[index(a)];
      if (Wide{sum(a, b)} < Wide{sigma_nano} * pairs(a, b)) return;
      join(a, b);
      for (int c = 0; c < n_; ++c) {
        if (size_[index(c)] == 0) continue;
        if (c == a || best_[index(c)] == a || best_[index(c)] == b) {
          findBest(c);
        } else if (a > c && sum(c, a) != kApart &&
                   (best_[index(c)] < 0 || isBefore(c, a, c, best_[index(c)]))) {
          best_[index(c)] = a;
        }
      }
    }
  }

  int clusterOf(int rank) const { return cluster_[index(rank)]; }

 private:
  static size_t index(int i) { return static_cast<size_t>(i); }
  int64_t sum(int a, int b) const { return sum_[index(a) * index(n_) + index(b)]; }
  void setSum(int a, int b, int64_t value) {
    sum_[index(a) * index(n_) + index(b)] = value;
    sum_[index(b) * index(n_) + index(a)] = value;
  }
  int64_t pairs(int a, int b) const { return size_[index(a)] * size_[index(b)]; }

  // Whether a and b are to be joined before c and d.
  bool isBefore(int a, int b, int c, int d) const {
    const Wide one = Wide{sum(a, b)} * pairs(c, d), other = Wide{sum(c, d)} * pairs(a, b);
    return one != other ? one > other : std::pair(a, b) < std::pair(c, d);
  }

  // The best partner of a cluster among those after it; the first of equals.
  void findBest(int a) {
    int best = -1;
    for (int b = a + 1; b < n_; ++b) {
      if (size_[index(b)] == 0 || sum(a, b) == kApart) continue;
      if (best < 0 || isBefore(a, b, a, best)) best = b;
    }
    best_[index(a)] = best;
  }

  void join(int a, int b) {  // a < b
    for (int c = 0; c < n_; ++c) {
      if (size_[index(c)] == 0 || c == a || c == b) continue;
      const int64_t one = sum(a, c), other = sum(b, c);
      setSum(a, c, one == kApart || other == kApart ? kApart : one + other);
    }
    size_[index(a)] += size_[index(b)];
    size_[index(b)] = 0;
    std::ranges::replace(cluster_, b, a);
  }

  int n_;
  std::vector<int64_t> sum_;   // of the similarities between two clusters
  std::vector<int64_t> size_;  // 0: joined into another
  std::vector<int> best_;      // per cluster
  std::vector<int> cluster_;   // per rank
};

}  // namespace

std::vector<int> averageLinkage(const PairTable& similarity, int64_t sigma_nano, std::span<const int> rank,
                                const PairConstraints& constraints) {
  SHOAL_DEMAND(std::ssize(rank) == similarity.size());
  Linkage linkage(similarity, rank, constraints);
  linkage.joinWhileAtLeast(sigma_nano);
  std::vector<int> label;
  for (const int r : rank) label.push_back(linkage.clusterOf(r));
  return label;
}

}  // namespace shoal::matching
