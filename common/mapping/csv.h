// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "shoal/world/ids.h"

namespace shoal::mapping {

/// A number with a fixed count of decimals, `.` as decimal mark whatever the locale, never "-0.000".
std::string fixed(double value, int decimals);

/// A field as RFC 4180 wants it: quoted when it holds a comma, a quote or a line break.
std::string quoted(std::string_view field);

/// Reads CSV text with a header line. Fields may be quoted; lines end in LF or CRLF.
/// @throws std::runtime_error naming `path`, the line and what is wrong, when the header is not exactly
///         `columns` (more columns to the right are fine) or a row has another number of fields.
std::vector<std::vector<std::string>> parseCsv(const std::string& text,
                                               const std::vector<std::string>& columns,
                                               const std::string& path);

/// Numbers out of fields. @throws std::runtime_error naming the path and the field.
double toReal(const std::string& field, const std::string& path);
int64_t toInteger(const std::string& field, const std::string& path);

/// The time that files tell as seconds, to the millisecond.
world::Timestamp timeFromSeconds(double seconds);

}  // namespace shoal::mapping
