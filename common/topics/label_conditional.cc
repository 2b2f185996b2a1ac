// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/label_conditional.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "shoal/demand.h"
#include "shoal/topics/fixed_log.h"

namespace shoal::topics {
namespace {

__extension__ using Wide = __int128;

// counted / all of it.
int64_t shareOf(int64_t log_likelihood, int64_t counted, int64_t all) {
  return static_cast<int64_t>(static_cast<Wide>(log_likelihood) * counted / all);
}

// log2 of the weights, up to a constant, in units of 2^-16.
class LogWeights {
 public:
  LogWeights(std::span<const int64_t> log_likelihoods, int64_t num_words, std::span<const int32_t> alike,
             const ConditionalScale& scale)
      : log_likelihoods_(log_likelihoods),
        alike_(alike),
        coupling_(scale.coupling),
        all_(num_words * kLogOne),
        counted_(std::min(scale.evidence, all_)) {
    SHOAL_DEMAND(alike.size() == log_likelihoods.size() && num_words > 0);
  }
  int64_t of(size_t k) const { return shareOf(log_likelihoods_[k], counted_, all_) + coupling_ * alike_[k]; }

 private:
  std::span<const int64_t> log_likelihoods_;
  std::span<const int32_t> alike_;
  int64_t coupling_, all_, counted_;
};

}  // namespace

ConditionalScale ConditionalScale::of(double evidence, double coupling) {
  const auto fixed = [](double x) { return static_cast<int64_t>(std::floor(x * kLogOne + 0.5)); };
  return {.evidence = fixed(evidence), .coupling = fixed(coupling * std::numbers::log2e)};
}

void weighLabels(std::span<const int64_t> log_likelihoods, int64_t num_words, std::span<const int32_t> alike,
                 const ConditionalScale& scale, std::span<uint64_t> weights) {
  SHOAL_DEMAND(weights.size() == alike.size());
  const LogWeights log_weights(log_likelihoods, num_words, alike, scale);
  int64_t largest = std::numeric_limits<int64_t>::min();
  for (size_t k = 0; k < alike.size(); ++k) {
    if (alike[k] != kNotALabel) largest = std::max(largest, log_weights.of(k));
  }
  for (size_t k = 0; k < alike.size(); ++k) {
    weights[k] = alike[k] == kNotALabel ? 0 : fixedExp2(largest - log_weights.of(k));
  }
}

int32_t likeliestLabel(std::span<const int64_t> log_likelihoods, int64_t num_words,
                       std::span<const int32_t> alike, const ConditionalScale& scale) {
  const LogWeights log_weights(log_likelihoods, num_words, alike, scale);
  int32_t best = -1;
  int64_t largest = 0;
  for (size_t k = 0; k < alike.size(); ++k) {
    if (alike[k] == kNotALabel) continue;
    const int64_t weight = log_weights.of(k);
    if (best >= 0 && weight <= largest) continue;
    best = static_cast<int32_t>(k);
    largest = weight;
  }
  SHOAL_DEMAND(best >= 0);
  return best;
}

int64_t weightOfWords(int64_t log_likelihood, int64_t num_words, const ConditionalScale& scale) {
  SHOAL_DEMAND(num_words > 0);
  const int64_t all = num_words * kLogOne;
  return shareOf(log_likelihood, std::min(scale.evidence, all), all);
}

int32_t drawLabel(std::span<const uint64_t> weights, Random& random) {
  uint64_t point = random.below(std::accumulate(weights.begin(), weights.end(), uint64_t{0}));
  for (size_t k = 0; k < weights.size(); ++k) {
    if (point < weights[k]) return static_cast<int32_t>(k);
    point -= weights[k];
  }
  constexpr bool kPointBelowSum = false;
  SHOAL_DEMAND(kPointBelowSum);
}

}  // namespace shoal::topics
