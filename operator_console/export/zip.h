// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>

namespace shoal::console {

/// A file that an export consists of.
struct ExportedFile {
  std::string name;  ///< without a folder
  std::string content;
};

/// Files as one ZIP archive, stored as they are, dated 1980-01-01: same files, same bytes.
/// @throws std::runtime_error when they are larger than 4 GB together.
std::string zipOf(std::span<const ExportedFile> files);

}  // namespace shoal::console
