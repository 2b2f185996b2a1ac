// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/twin_labels.h"

#include <algorithm>
#include <cmath>

namespace shoal::topics {
namespace {

constexpr double kPriorWords = 100;
constexpr double kUniformVotes = 0.25;
constexpr double kOne = 1 << 20;  // a root of a probability of 1: products and their sums are exact

// sqrt(φ) - sqrt(b) of every label, label-major, in units of 1 / kOne.
std::vector<int32_t> contrasts(const LabelCounts& counts, std::span<const int32_t> labels) {
  const auto vocabulary = static_cast<size_t>(counts.vocabularySize());
  std::vector<int32_t> rows(labels.size() * vocabulary);
  std::vector<double> total(labels.size());
  for (const world::WordGroup& group : counts.groups()) {
    std::ranges::fill(total, 0.0);
    for (int32_t w = group.first; w < group.first + group.size; ++w) {
      const std::span<const int32_t> row = counts.wordCounts(w);
      for (size_t i = 0; i < labels.size(); ++i) total[i] += row[static_cast<size_t>(labels[i])];
    }
    double votes = kUniformVotes;
    for (const double words : total) votes += words > 0 ? 1 : 0;
    for (int32_t w = group.first; w < group.first + group.size; ++w) {
      const std::span<const int32_t> row = counts.wordCounts(w);
      double sum = kUniformVotes / group.size;
      for (size_t i = 0; i < labels.size(); ++i) {
        if (total[i] > 0) sum += row[static_cast<size_t>(labels[i])] / total[i];
      }
      const double background = sum / votes, root = std::sqrt(background);
      for (size_t i = 0; i < labels.size(); ++i) {
        const double mixed =
            (row[static_cast<size_t>(labels[i])] + kPriorWords * background) / (total[i] + kPriorWords);
        rows[i * vocabulary + static_cast<size_t>(w)] =
            static_cast<int32_t>(std::floor((std::sqrt(mixed) - root) * kOne));
      }
    }
  }
  return rows;
}

int64_t dot(std::span<const int32_t> a, std::span<const int32_t> b) {
  int64_t sum = 0;
  for (size_t w = 0; w < a.size(); ++w) sum += int64_t{a[w]} * b[w];
  return sum;
}

// Cosines of all pairs, n x n.
std::vector<double> similarities(std::span<const int32_t> rows, size_t n) {
  const size_t vocabulary = n == 0 ? 0 : rows.size() / n;
  const auto row = [&](size_t i) { return rows.subspan(i * vocabulary, vocabulary); };
  std::vector<double> length(n), similarity(n * n);
  for (size_t i = 0; i < n; ++i) length[i] = std::sqrt(static_cast<double>(dot(row(i), row(i))));
  for (size_t i = 0; i < n; ++i) {
    for (size_t j = 0; j < i; ++j) {
      const double lengths = length[i] * length[j];
      const double cosine = lengths > 0 ? static_cast<double>(dot(row(i), row(j))) / lengths : 0.0;
      similarity[i * n + j] = similarity[j * n + i] = cosine;
    }
  }
  return similarity;
}

}  // namespace

std::vector<int32_t> twinLabels(const LabelCounts& counts, std::span<const int32_t> labels, double least) {
  const size_t n = labels.size();
  std::vector<size_t> set_of(n);  // by its first member
  for (size_t i = 0; i < n; ++i) set_of[i] = i;
  std::vector<int32_t> twins(labels.begin(), labels.end());
  if (least >= 1 || n < 2) return twins;

  std::vector<double> sum = similarities(contrasts(counts, labels), n);  // over pairs of members of two sets
  std::vector<double> members(n, 1.0);                                   // 0: joined to another
  while (true) {
    double best = least;
    size_t first = n, second = n;
    for (size_t i = 0; i < n; ++i) {
      for (size_t j = i + 1; j < n && members[i] > 0; ++j) {
        if (members[j] == 0) continue;
        const double mean = sum[i * n + j] / (members[i] * members[j]);
        if (mean > best || (mean == best && first == n)) {
          best = mean;
          first = i;
          second = j;
        }
      }
    }
    if (first == n) break;
    for (size_t k = 0; k < n; ++k) {
      sum[first * n + k] += sum[second * n + k];
      sum[k * n + first] = sum[first * n + k];
      if (set_of[k] == second) set_of[k] = first;
    }
    members[first] += members[second];
    members[second] = 0;
  }
  for (size_t i = 0; i < n; ++i) twins[i] = labels[set_of[i]];
  return twins;
}

}  // namespace shoal::topics
