// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

namespace shoal::eval {

/// The mean of a sample and how sure it is.
struct Summary {
  int count = 0;
  double mean = 0;
  double deviation = 0;  ///< standard deviation of the sample (n - 1); 0 for fewer than two
  double margin = 0;     ///< half of the 95 % confidence interval of the mean (Student); 0 for fewer than two
};

Summary summarize(std::span<const double> sample);

/// The straight line through points by least squares; a slope without spread in x is 0.
struct Line {
  double slope = 0, intercept = 0;
  double slope_margin = 0;  ///< half of the slope's 95 % confidence interval; 0 for fewer than three points
};
Line fitLine(std::span<const double> x, std::span<const double> y);

/// The 97.5 % quantile of Student's distribution: half the width of a 95 % interval in standard errors.
/// To a thousandth. @throws std::invalid_argument for less than one degree of freedom.
double studentQuantile(int degrees_of_freedom);

}  // namespace shoal::eval
