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

}  // namespace

ConditionalScale ConditionalScale::of(double evidence, double coupling) {
  const auto fixed = [](double x) { return static_cast<int64_t>(std::floor(x * kLogOne + 0.5)); };
  return {.evidence = fixed(evidence), .coupling = fixed(coupling * std::numbers::log2e)};
}

void weighLabels(std::span<const int64_t> log_likelihoods, int64_t num_words, std::span<const int32_t> alike,
                 const ConditionalScale& scale, std::span<uint64_t> weights) {
  SHOAL_DEMAND(alike.size() == log_likelihoods.size() && weights.size() == alike.size() && num_words > 0);
  const int64_t all = num_words * kLogOne;
  const int64_t counted = std::min(scale.evidence, all);
  const auto logWeight = [&](size_t k) {
    const auto words = static_cast<int64_t>(static_cast<Wide>(log_likelihoods[k]) * counted / all);
    return words + scale.coupling * alike[k];
  };
  int64_t largest = std::numeric_limits<int64_t>::min();
  for (size_t k = 0; k < alike.size(); ++k) {
    if (alike[k] != kNotALabel) largest = std::max(largest, logWeight(k));
  }
  for (size_t k = 0; k < alike.size(); ++k) {
    weights[k] = alike[k] == kNotALabel ? 0 : fixedExp2(largest - logWeight(k));
  }
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
