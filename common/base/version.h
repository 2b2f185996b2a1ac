// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace shoal {

/// Release of this build, "major.minor.patch".
const char* version();

/// Abbreviated git commit that was built, "unknown" outside a checkout.
const char* commit();

}  // namespace shoal
