// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string_view>

namespace shoal::mapping {

inline constexpr size_t kMaxLabelNameBytes = 64;

/// True for names that a label may have: at most 64 bytes of well-formed UTF-8 without control characters.
/// The empty name is one: it takes a name away.
bool isLabelName(std::string_view text);

}  // namespace shoal::mapping
