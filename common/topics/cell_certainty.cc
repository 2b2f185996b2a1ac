// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/cell_certainty.h"

#include "shoal/demand.h"
#include "shoal/topics/fixed_log.h"

namespace shoal::topics {
namespace {

// Chosen by logistic regression: docs/labels.md.
constexpr int64_t kOffset = -69632;  // -1.0625 in units of 2^-16
constexpr int64_t kSlope = 160;      // .625 in units of 2^-8

}  // namespace

float cellCertainty(int64_t log_own, int64_t log_other, int64_t num_words, int64_t log_group_size) {
  SHOAL_DEMAND(num_words > 0);
  const int64_t bits = (2 * log_own - log_other) / num_words + log_group_size;
  const int64_t x = kOffset + bits * kSlope / 256;
  constexpr auto kOne = static_cast<double>(int64_t{1} << 32);
  const auto power = static_cast<double>(fixedExp2(x < 0 ? -x : x));
  return static_cast<float>(x < 0 ? power / (kOne + power) : kOne / (kOne + power));
}

}  // namespace shoal::topics
