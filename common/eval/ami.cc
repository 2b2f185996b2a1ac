// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/ami.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace shoal::eval {
namespace {

// The mean of (n/N) log(N n / (a b)) over the n that two sets of a and b cells have in common when the cells
// are shuffled. Goes outwards from the mode by the ratio of neighbouring probabilities and divides by their
// sum, so no factorial appears, and nothing is lost to the size of its logarithm.
double summedTerm(int64_t a, int64_t b, int64_t total) {
  const auto real = [](int64_t x) { return static_cast<double>(x); };
  const auto term = [&](int64_t n) {
    return n == 0 ? 0.0 : real(n) / real(total) * std::log(real(n) / real(a) * (real(total) / real(b)));
  };
  const int64_t least = std::max<int64_t>(0, a + b - total);
  const int64_t most = std::min(a, b);
  const auto guess = static_cast<int64_t>((real(a) + 1.0) * (real(b) + 1.0) / (real(total) + 2.0));
  const int64_t mode = std::clamp(guess, least, most);

  constexpr double kNegligible = 1e-20;
  double weights = 1.0;
  double sum = term(mode);
  double weight = 1.0;
  for (int64_t n = mode; n < most && weight > kNegligible; ++n) {
    weight *= real(a - n) / real(n + 1) * (real(b - n) / real(total - a - b + n + 1));
    weights += weight;
    sum += weight * term(n + 1);
  }
  weight = 1.0;
  for (int64_t n = mode; n > least && weight > kNegligible; --n) {
    weight *= real(n) / real(a - n + 1) * (real(total - a - b + n) / real(b - n + 1));
    weights += weight;
    sum += weight * term(n - 1);
  }
  return sum / weights;
}

// The same for sets that have many cells in common: the mean of n log n from the first four central moments m
// of the hypergeometric distribution, by Taylor's series about its mean u. The next terms are of relative
// size 1/u^2 of a sum that is itself small against the entropies.
double momentsTerm(int64_t a_cells, int64_t b_cells, int64_t num_cells) {
  const auto a = static_cast<double>(a_cells), b = static_cast<double>(b_cells),
             n = static_cast<double>(num_cells);
  const double p = a / n, q = 1.0 - p, r = b / n, s = 1.0 - r;
  const double u = a * r;
  const double m2 = u * q * s * n / (n - 1.0);
  const double m3 = m2 * (1.0 - 2.0 * p) * (1.0 - 2.0 * r) * n / (n - 2.0);
  // Kurtosis of the hypergeometric distribution in the limit of many cells: 3 m2^2 and a term in m2.
  const double m4 = m2 * m2 * 3.0 + m2 * (1.0 - 6.0 * p * q) * (1.0 - 6.0 * r * s);
  return (m2 / (2.0 * u) - m3 / (6.0 * u * u) + m4 / (12.0 * u * u * u)) / n;
}

double expectedTerm(int64_t a, int64_t b, int64_t total) {
  constexpr double kMany = 4096;
  const double common = static_cast<double>(a) * static_cast<double>(b) / static_cast<double>(total);
  return common > kMany ? momentsTerm(a, b, total) : summedTerm(a, b, total);
}

std::map<int64_t, int64_t> multiplicities(const std::vector<int64_t>& cells) {
  std::map<int64_t, int64_t> times;
  for (const int64_t n : cells) ++times[n];
  return times;
}

}  // namespace

double entropy(const std::vector<int64_t>& cells) {
  const auto total = static_cast<double>(std::accumulate(cells.begin(), cells.end(), int64_t{0}));
  double sum = 0.0;
  for (const int64_t n : cells) {
    if (n > 0) sum -= static_cast<double>(n) / total * std::log(static_cast<double>(n) / total);
  }
  return sum;
}

double mutualInformation(const Contingency& table) {
  const auto total = static_cast<double>(table.num_cells);
  double sum = 0.0;
  for (const Contingency::Count& count : table.counts) {
    const auto n = static_cast<double>(count.cells);
    const auto a = static_cast<double>(table.label_cells[static_cast<size_t>(count.label)]);
    const auto b = static_cast<double>(table.truth_cells[static_cast<size_t>(count.truth)]);
    sum += n / total * std::log(n / a * (total / b));
  }
  return std::max(sum, 0.0);
}

double expectedMutualInformation(const Contingency& table) {
  // Labels of equal size share their terms.
  double sum = 0.0;
  for (const auto& [a, times_a] : multiplicities(table.label_cells)) {
    for (const auto& [b, times_b] : multiplicities(table.truth_cells)) {
      sum += static_cast<double>(times_a * times_b) * expectedTerm(a, b, table.num_cells);
    }
  }
  return sum;
}

double ami(const Contingency& table) {
  if (table.num_cells == 0) return 0.0;
  if (table.label_ids.size() == 1 && table.truth_ids.size() == 1) return 1.0;
  const double expected = expectedMutualInformation(table);
  const double most = std::max(entropy(table.label_cells), entropy(table.truth_cells));
  // All cells alone: both differences are 0, and round-off must not make a score of their quotient.
  if (std::abs(most - expected) <= 1e-12 * most) return 0.0;
  return (mutualInformation(table) - expected) / (most - expected);
}

double nmi(const Contingency& table) {
  if (table.num_cells == 0) return 0.0;
  if (table.label_ids.size() == 1 && table.truth_ids.size() == 1) return 1.0;
  return mutualInformation(table) / std::max(entropy(table.label_cells), entropy(table.truth_cells));
}

}  // namespace shoal::eval
