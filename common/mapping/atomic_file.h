// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace shoal::mapping {

/// Writes a file whole or not at all: to a temporary name in the same folder, flushed, then renamed. Makes
/// the folder when it is missing.
/// @throws std::runtime_error naming the path and what the system said.
void writeFileAtomically(const std::string& path, std::string_view content);

/// The whole of a file. @throws std::runtime_error naming the path when it cannot be read.
std::string readFile(const std::string& path);

}  // namespace shoal::mapping
