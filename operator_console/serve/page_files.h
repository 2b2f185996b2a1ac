// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace shoal::console {

/// A file of the page, as it lies in this program.
struct PageFile {
  const char* type;  ///< content type
  std::string_view content;
};

/// The file at a path of the server, such as "/" or "/page.js"; nullptr when there is none.
const PageFile* pageFile(std::string_view path);

}  // namespace shoal::console
