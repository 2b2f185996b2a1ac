// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace shoal::mapping {

/// Makes a folder, and those above it, where it is missing: before long work, for what that is to write.
/// @throws std::runtime_error naming the folder and what the system said when it cannot be made or written
/// into.
void makeFolder(const std::string& folder);

/// Writes a file whole or not at all: to a temporary name in the same folder, flushed, then renamed; then
/// the folder is flushed, where its file system can. Makes the folder when it is missing. A link goes on
/// leading to its file, which is the one written. A device, a pipe or /dev/stdout is written into as it is.
/// @throws std::runtime_error naming the path and what the system said; the temporary file is gone then.
void writeFileAtomically(const std::string& path, std::string_view content);

/// The same of what lies in several places, one after the other.
void writeFileAtomically(const std::string& path, std::span<const std::string_view> contents);

/// The whole of a file. @throws std::runtime_error naming the path when it cannot be read.
std::string readFile(const std::string& path);

}  // namespace shoal::mapping
