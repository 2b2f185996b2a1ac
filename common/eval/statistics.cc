// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/statistics.h"

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace shoal::eval {

double studentQuantile(int degrees_of_freedom) {
  if (degrees_of_freedom < 1) {
    throw std::invalid_argument("degrees of freedom must be at least 1, got " +
                                std::to_string(degrees_of_freedom));
  }
  // Exact where the distribution is far from normal; beyond, Abramowitz and Stegun 26.7.5.
  constexpr std::array kFirst = {12.7062, 4.3027, 3.1824, 2.7764, 2.5706,
                                 2.4469,  2.3646, 2.3060, 2.2622, 2.2281};
  if (degrees_of_freedom <= static_cast<int>(kFirst.size())) {
    return kFirst[static_cast<size_t>(degrees_of_freedom - 1)];
  }
  constexpr double x = 1.959964;
  const double n = degrees_of_freedom;
  const double x3 = x * x * x, x5 = x3 * x * x, x7 = x5 * x * x;
  return x + (x3 + x) / (4 * n) + (5 * x5 + 16 * x3 + 3 * x) / (96 * n * n) +
         (3 * x7 + 19 * x5 + 17 * x3 - 15 * x) / (384 * n * n * n);
}

Summary summarize(std::span<const double> sample) {
  Summary result{.count = static_cast<int>(sample.size())};
  if (sample.empty()) return result;
  const auto n = static_cast<double>(sample.size());
  for (const double value : sample) result.mean += value / n;
  if (sample.size() < 2) return result;
  double squares = 0;
  for (const double value : sample) squares += (value - result.mean) * (value - result.mean);
  result.deviation = std::sqrt(squares / (n - 1));
  result.margin = studentQuantile(result.count - 1) * result.deviation / std::sqrt(n);
  return result;
}

Line fitLine(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size()) throw std::invalid_argument("a line needs as many x as y");
  const double mean_x = summarize(x).mean, mean_y = summarize(y).mean;
  double xx = 0, xy = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  Line line;
  line.slope = xx > 0 ? xy / xx : 0.0;
  line.intercept = mean_y - line.slope * mean_x;
  if (x.size() < 3 || xx == 0) return line;
  double left = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    const double error = y[i] - line.intercept - line.slope * x[i];
    left += error * error;
  }
  const int freedom = static_cast<int>(x.size()) - 2;
  line.slope_margin = studentQuantile(freedom) * std::sqrt(left / freedom / xx);
  return line;
}

}  // namespace shoal::eval
