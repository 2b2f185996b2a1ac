// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace shoal::console {

/// Bytes as base64 (RFC 4648, padded): for data: URLs.
std::string base64(std::string_view bytes);

}  // namespace shoal::console
