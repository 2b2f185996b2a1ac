// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/likeliest_labels.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "shoal/demand.h"

namespace shoal::topics {
namespace {

constexpr int32_t kCellsBetweenBreaths = 8192;

}  // namespace

void LabelCandidates::add(std::span<const int64_t> log_likelihoods, int64_t num_words,
                          std::span<const int64_t> in_favour) {
  SHOAL_DEMAND(numCells() < neighborhood_.size() && !log_likelihoods.empty());
  if (num_labels_ == 0) num_labels_ = static_cast<int32_t>(log_likelihoods.size());
  SHOAL_DEMAND(std::ssize(log_likelihoods) == num_labels_ && in_favour.size() == log_likelihoods.size());
  weights_.clear();
  int64_t heaviest = std::numeric_limits<int64_t>::min(), best = heaviest, second = heaviest;
  for (size_t i = 0; i < log_likelihoods.size(); ++i) {
    weights_.push_back(weightOfWords(log_likelihoods[i], num_words, scale_) + in_favour[i]);
    heaviest = std::max(heaviest, weights_[i]);
    second = std::max(second, std::min(best, log_likelihoods[i]));
    best = std::max(best, log_likelihoods[i]);
  }
  const auto votes = static_cast<int64_t>(neighborhood_.of(numCells()).size());
  const int64_t least = heaviest - scale_.coupling * votes;
  for (int32_t k = 0; k < num_labels_; ++k) {
    const auto i = static_cast<size_t>(k);
    if (weights_[i] >= least || log_likelihoods[i] >= second)
      candidates_.push_back({k, log_likelihoods[i], weights_[i]});
  }
  first_.push_back(candidates_.size());
}

std::vector<int32_t> likeliestLabels(const LabelCandidates& candidates, int rounds,
                                     const std::function<void()>& breathe) {
  const int32_t num_cells = candidates.numCells();
  SHOAL_DEMAND(num_cells == candidates.neighborhood().size());
  const int64_t coupling = candidates.scale().coupling;
  std::vector<int32_t> votes(static_cast<size_t>(candidates.numLabels()));
  std::vector<int32_t> label(static_cast<size_t>(num_cells));
  const auto likeliest = [&](int32_t c) {
    if (c % kCellsBetweenBreaths == 0) breathe();
    int32_t best = -1;
    int64_t largest = 0;
    for (const LabelCandidates::Candidate& candidate : candidates.of(c)) {
      const int64_t weight = candidate.weight + coupling * votes[static_cast<size_t>(candidate.label)];
      if (best >= 0 && weight <= largest) continue;
      best = candidate.label;
      largest = weight;
    }
    return best;
  };
  for (int32_t c = 0; c < num_cells; ++c) label[static_cast<size_t>(c)] = likeliest(c);
  bool changes = true;
  for (int round = 0; round < rounds && changes; ++round) {
    changes = false;
    for (int32_t c = 0; c < num_cells; ++c) {
      const std::span<const int32_t> neighbors = candidates.neighborhood().of(c);
      for (const int32_t n : neighbors) ++votes[static_cast<size_t>(label[static_cast<size_t>(n)])];
      const int32_t now = likeliest(c);
      for (const int32_t n : neighbors) votes[static_cast<size_t>(label[static_cast<size_t>(n)])] = 0;
      changes |= now != std::exchange(label[static_cast<size_t>(c)], now);
    }
  }
  return label;
}

}  // namespace shoal::topics
