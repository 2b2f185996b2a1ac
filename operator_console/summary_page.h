// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace shoal::console {

/// A finished mission as one HTML page that needs nothing else: the map, each label with its area and who
/// found it when, rare finds, what was decided, the link, what went wrong, and when it was recorded the
/// verdict of verify().
/// @param dir  a run's folder. @throws std::runtime_error naming the file that is missing or broken.
std::string summaryPage(const std::string& dir);

}  // namespace shoal::console
