// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace shoal::console {

/// What of a mission is in a folder that cannot be had again: mission.lcmlog, edits.json and the files of
/// state/ that nodes remember it by; paths from `dir`, in that order.
std::vector<std::string> remainsOf(const std::string& dir);

/// Removes what a mission writes from a folder, and the folders that are then empty. What is not of its names
/// stays: somebody keeps it there.
void removeMission(const std::string& dir);

/// The first of the files that a mission is to write into a folder, if one is there already; else empty.
std::string fileOfMission(const std::string& dir);

/// How to ask what is left of a mission that did not end: a command line for the recording, else for what a
/// node remembers. Empty without either.
std::string howToAsk(const std::string& dir);

}  // namespace shoal::console
