// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace shoal::fusion_node {

/// Of how many robots and nodes a process remembers anything: a hostile peer must not make us remember
/// without end.
inline constexpr size_t kMaxNodes = 300;

}  // namespace shoal::fusion_node
