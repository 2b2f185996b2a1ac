// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "shoal/topics/make_learner.h"

namespace shoal::robot {

/// How robots of a profile learn: "paper" labels every word, "best" every cell.
/// @throws std::invalid_argument naming a profile that does not exist.
topics::LearnerHyperparameters hyperparametersOf(const std::string& profile);

}  // namespace shoal::robot
