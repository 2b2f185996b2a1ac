// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <charconv>
#include <cmath>
#include <string>
#include <system_error>

namespace shoal {

/// Whether all of `text` is a finite number, at least 0 or above it; else what is wrong with it, for who
/// typed it: "must be 0 or more, got -5". In the form in which CLI11 wants a check; empty when nothing is
/// wrong.
inline std::string wrongWithNumber(const std::string& text, bool may_be_zero) {
  double value = 0;
  const char* last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, value);
  const bool is_number = error == std::errc{} && end == last && std::isfinite(value);
  if (is_number && (may_be_zero ? value >= 0 : value > 0)) return "";
  return (may_be_zero ? "must be 0 or more, got " : "must be more than 0, got ") + text;
}

inline std::string zeroOrMore(const std::string& text) { return wrongWithNumber(text, true); }
inline std::string moreThanZero(const std::string& text) { return wrongWithNumber(text, false); }

}  // namespace shoal
