// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace shoal {

/// The value to the nearest 1/per_unit, as answers and files tell it; never -0.
/// @param per_unit  > 0, such as 1e3 for millimetres of metres.
inline double rounded(double value, double per_unit) {
  const double result = std::round(value * per_unit) / per_unit;
  return result == 0.0 ? 0.0 : result;
}

}  // namespace shoal
