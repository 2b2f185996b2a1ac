// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace shoal::fusion_node {

/// What keys of the file that `app` was given by --config are likely typing errors, a sentence each: no flags
/// of any command of the program, but nearly one of the chosen command. Other keys are passed over: one
/// mission.toml serves all our programs. So is what is no file on a disk: it can be read once.
std::vector<std::string> likelyTypos(const CLI::App& app);

}  // namespace shoal::fusion_node
