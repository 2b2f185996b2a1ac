// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "shoal/topics/known_topics.h"

namespace shoal::robot {

/// The topics of an earlier mission to begin with: a robot's topics.json.
/// @param profile  whose words they must have been learnt with: group by group of the same name and size.
/// @throws std::runtime_error naming the file and what is wrong with it; std::invalid_argument for a profile
/// that
///         does not exist.
std::vector<topics::KnownTopic> readKnownTopics(const std::string& path, const std::string& profile);

}  // namespace shoal::robot
