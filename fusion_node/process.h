// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace shoal::fusion_node {

/// Sends log lines to stderr in the one format of all our processes: time, level, node, message.
/// @throws std::invalid_argument for a level other than trace, debug, info, warn, error, off.
void setUpLog(const std::string& node, const std::string& level);

/// From now on SIGINT and SIGTERM only set a flag.
void catchStopSignals();
bool stopRequested();

/// A mission's number: the decimal number itself, or a hash of any other text. Never 0.
int32_t missionId(const std::string& text);

/// Hash of this host's name, to tell two processes with one robot id apart.
int32_t hostHash();

/// The rate of mission time: "max" is 0, else a factor such as 1 or 10.
/// @throws std::invalid_argument naming the text.
double parseRate(const std::string& text);

}  // namespace shoal::fusion_node
