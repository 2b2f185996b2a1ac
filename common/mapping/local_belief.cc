// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/local_belief.h"

#include <algorithm>
#include <cmath>

namespace shoal::mapping {

std::string_view toText(Detail detail) { return detail == Detail::kFine ? "fine" : "coarse"; }

std::optional<Detail> parseDetail(std::string_view text) {
  for (const Detail detail : {Detail::kFine, Detail::kCoarse})
    if (toText(detail) == text) return detail;
  return std::nullopt;
}

namespace {

constexpr double kCoarseCosine = 0.99;  // of coarse topics to the exact counts, at least
constexpr double kMostCoarse = 0.1;     // the largest unit, as a share of the norm

// Fine ones are rounded half up. Coarse ones go up from five eighths on: what small counts lose saves more
// bytes than the smaller unit that makes up for it costs.
double roundingOf(Detail detail) { return detail == Detail::kFine ? 0.5 : 0.375; }

double levelOf(int32_t count, double unit, double rounding) { return std::floor(count / unit + rounding); }

// Whether coarse counts in whole units keep the cosine. Sums of integers below 2^53: exact.
bool keepsCosine(const std::vector<world::WordCount>& counts, double squares, double unit) {
  double products = 0, levels = 0;
  for (const world::WordCount& w : counts) {
    const double level = levelOf(w.count, unit, roundingOf(Detail::kCoarse));
    products += w.count * level;
    levels += level * level;
  }
  return products * products > kCoarseCosine * kCoarseCosine * squares * levels;
}

}  // namespace

std::vector<world::WordCount> quantize(const std::vector<world::WordCount>& counts, Detail detail) {
  double squares = 0;  // of integers, and below 2^53 for any count of words a robot can see: exact
  for (const world::WordCount& w : counts) squares += static_cast<double>(w.count) * w.count;
  // sqrt is correctly rounded by IEEE 754, so every machine gets the same integers.
  const double norm = std::sqrt(squares);
  const double step = std::max(1.0, norm / 1000.0);
  double unit = detail == Detail::kFine ? 1.0 : std::max(1.0, std::floor(norm / step * kMostCoarse));
  while (unit > 1 && !keepsCosine(counts, squares, step * unit)) --unit;
  const double rounding = unit > 1 ? roundingOf(detail) : roundingOf(Detail::kFine);
  std::vector<world::WordCount> quantized;
  for (const world::WordCount& w : counts) {
    const double level = levelOf(w.count, step * unit, rounding);
    if (level > 0) quantized.push_back({w.word, static_cast<int32_t>(level * unit)});
  }
  return quantized;
}

uint8_t certaintySteps(float certainty, Detail detail) {
  const long ninths = std::lround(std::clamp(certainty, 0.f, 1.f) * 9);
  const long thirds = (ninths + 1) / 3;
  return static_cast<uint8_t>(detail == Detail::kFine ? ninths * (kCertaintySteps / 9)
                                                      : thirds * (kCertaintySteps / 3));
}

uint8_t surpriseSteps(float surprise) {
  const float most = static_cast<float>(kMostSurpriseSteps) / kSurpriseStepsPerUnit;
  const long steps = std::lround(std::clamp(surprise, 0.f, most) * kSurpriseStepsPerUnit);
  return steps < kLeastSurpriseSteps ? uint8_t{0} : static_cast<uint8_t>(steps);
}

}  // namespace shoal::mapping
