// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "shoal/topics/hyperparameters.h"

namespace shoal::robot {

/// The hyper-parameters of a profile.
/// @throws std::invalid_argument naming a profile that is not built.
topics::Hyperparameters hyperparametersOf(const std::string& profile);

}  // namespace shoal::robot
