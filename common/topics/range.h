// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sstream>
#include <stdexcept>

namespace shoal::topics {

/// @throws std::invalid_argument naming the field, the range and the value if it lies outside or is NaN.
template <typename T>
void checkRange(const char* name, T value, T low, T high) {
  if (value >= low && value <= high) return;  // false for NaN
  std::ostringstream message;
  message << name << " must lie in [" << low << ", " << high << "], got " << value;
  throw std::invalid_argument(message.str());
}

}  // namespace shoal::topics
